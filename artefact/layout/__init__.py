"""Bodies on a blank: pillars, posts and holes, whole standards, rival artefacts.

In: a `Blank` with its limits. Out: upright candidates with smooth shapes, which of them fit
beside each other, and rivals. A further rival is one more entry in `rivals`.
"""

from matstd.artefact.layout.blank import Blank as Blank
from matstd.artefact.layout.blank import Fittings as Fittings
from matstd.artefact.layout.post import cantilever_stiffness as cantilever_stiffness
from matstd.artefact.layout.post import post_stiffness as post_stiffness
from matstd.artefact.layout.rival_artefacts import rivals as rivals
from matstd.artefact.layout.rival_artefacts import with_spheres as with_spheres
from matstd.artefact.layout.side_by_side import beside_balls as beside_balls
from matstd.artefact.layout.side_by_side import most_side_by_side as most_side_by_side
from matstd.artefact.layout.upright import DEFAULT_MODULUS as DEFAULT_MODULUS
from matstd.artefact.layout.upright import WALL_GAP as WALL_GAP
from matstd.artefact.layout.upright import balls_fit as balls_fit
from matstd.artefact.layout.upright import balls_on_posts as balls_on_posts
from matstd.artefact.layout.upright import faces_beside as faces_beside
from matstd.artefact.layout.upright import faces_fit as faces_fit
from matstd.artefact.layout.upright import freeform_faces as freeform_faces
from matstd.artefact.layout.upright import holes_on as holes_on
from matstd.artefact.layout.upright import least_gap as least_gap
from matstd.artefact.layout.upright import least_mass as least_mass
from matstd.artefact.layout.wavy import Wave as Wave
from matstd.artefact.layout.wavy import wavy_face as wavy_face
