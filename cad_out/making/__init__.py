"""Whether a standard can be made, and how stiff it stands: cutters, first mode, sag.

In: a `Standard`. Out: a `Making` and `making.json`. Neither the CAD kernel nor a mesh is needed:
bodies answer for distances, and plate and pillars are cubes of finite elements.
"""

from matstd.cad_out.making.cutting import Cutting
from matstd.cad_out.making.hints import ROUGHNESS, FaceHint
from matstd.cad_out.making.joints import PAD_HEIGHT, Block, Joints, Stud, joints_of
from matstd.cad_out.making.making_file import FIRST_MODE, SAG, Making, making_of, write_making
from matstd.cad_out.making.stiffness import Stiffness, stiffness_of, with_sag

__all__ = [
    "FIRST_MODE",
    "PAD_HEIGHT",
    "ROUGHNESS",
    "SAG",
    "Block",
    "Cutting",
    "FaceHint",
    "Joints",
    "Making",
    "Stiffness",
    "Stud",
    "joints_of",
    "making_of",
    "stiffness_of",
    "with_sag",
    "write_making",
]
