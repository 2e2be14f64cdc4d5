"""Bodies on a blank: pillars, posts and holes, whole standards, rival artefacts.

In: a `Blank` with its limits. Out: upright candidates with smooth shapes, which of them fit
beside each other, and rivals. A further rival is one more entry in `rivals`.
"""

from matstd.artefact.layout.blank import Blank, Fittings
from matstd.artefact.layout.post import cantilever_stiffness, post_stiffness
from matstd.artefact.layout.rival_artefacts import rivals, with_spheres
from matstd.artefact.layout.side_by_side import beside_balls, most_side_by_side
from matstd.artefact.layout.upright import (
    DEFAULT_MODULUS,
    WALL_GAP,
    balls_fit,
    balls_on_posts,
    faces_beside,
    faces_fit,
    freeform_faces,
    holes_on,
    least_gap,
    least_mass,
)
from matstd.artefact.layout.wavy import Wave, wavy_face

__all__ = [
    "DEFAULT_MODULUS",
    "WALL_GAP",
    "Blank",
    "Fittings",
    "Wave",
    "balls_fit",
    "balls_on_posts",
    "beside_balls",
    "cantilever_stiffness",
    "faces_beside",
    "faces_fit",
    "freeform_faces",
    "holes_on",
    "least_gap",
    "least_mass",
    "most_side_by_side",
    "post_stiffness",
    "rivals",
    "wavy_face",
    "with_spheres",
]
