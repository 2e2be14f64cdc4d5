"""The standard: faces, spheres, body, limits and file, and the first contact of a moving ball.

In: control nets and places of faces, or a `standard.toml`. Out: a `Standard` whose surfaces return
points, normals and curvatures, whose bodies return distances, and whose `constraints` are numbers.
A new kind of face implements `Surface`; a new limit is one more yield in `limits`.
"""

from matstd.artefact.body.datum import DatumSphere, MountingHole, outline_distance
from matstd.artefact.body.first_contact import contact
from matstd.artefact.body.freeform import OVERHANG, ErrorShare, FreeformPatch, graph_patch
from matstd.artefact.body.known import Known, KnownFeature, Verdict
from matstd.artefact.body.limits import (
    Limits,
    check,
    constraints,
    max_slope,
    min_concave_radius,
)
from matstd.artefact.body.material import Material
from matstd.artefact.body.patch import Meeting
from matstd.artefact.body.solids import BLEND, Column, Plate
from matstd.artefact.body.sphere_fit import fitted_sphere
from matstd.artefact.body.standard import Base, Standard
from matstd.artefact.body.standard_file import read_standard, write_standard

__all__ = [
    "BLEND",
    "OVERHANG",
    "Base",
    "Column",
    "DatumSphere",
    "ErrorShare",
    "FreeformPatch",
    "Known",
    "KnownFeature",
    "Limits",
    "Material",
    "Meeting",
    "MountingHole",
    "Plate",
    "Standard",
    "Verdict",
    "check",
    "constraints",
    "contact",
    "fitted_sphere",
    "graph_patch",
    "max_slope",
    "min_concave_radius",
    "outline_distance",
    "read_standard",
    "write_standard",
]
