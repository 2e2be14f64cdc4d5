"""The standard: faces, spheres, body, limits and file, and the first contact of a moving ball.

In: control nets and places of faces, or a `standard.toml`. Out: a `Standard` whose surfaces return
points, normals and curvatures, whose bodies return distances, and whose `constraints` are numbers.
A new kind of face implements `Surface`; a new limit is one more yield in `limits`.
"""

from matstd.artefact.body.datum import DatumSphere as DatumSphere
from matstd.artefact.body.datum import MountingHole as MountingHole
from matstd.artefact.body.datum import fitted_sphere as fitted_sphere
from matstd.artefact.body.datum import outline_distance as outline_distance
from matstd.artefact.body.first_contact import contact as contact
from matstd.artefact.body.freeform import OVERHANG as OVERHANG
from matstd.artefact.body.freeform import ErrorShare as ErrorShare
from matstd.artefact.body.freeform import FreeformPatch as FreeformPatch
from matstd.artefact.body.freeform import graph_patch as graph_patch
from matstd.artefact.body.known import Known as Known
from matstd.artefact.body.known import KnownFeature as KnownFeature
from matstd.artefact.body.known import Verdict as Verdict
from matstd.artefact.body.limits import Limits as Limits
from matstd.artefact.body.limits import check as check
from matstd.artefact.body.limits import constraints as constraints
from matstd.artefact.body.limits import max_slope as max_slope
from matstd.artefact.body.limits import min_concave_radius as min_concave_radius
from matstd.artefact.body.material import Material as Material
from matstd.artefact.body.patch import Meeting as Meeting
from matstd.artefact.body.solids import BLEND as BLEND
from matstd.artefact.body.solids import Plate as Plate
from matstd.artefact.body.standard import Base as Base
from matstd.artefact.body.standard import Core as Core
from matstd.artefact.body.standard import Standard as Standard
from matstd.artefact.body.standard_file import read_standard as read_standard
from matstd.artefact.body.standard_file import write_standard as write_standard
