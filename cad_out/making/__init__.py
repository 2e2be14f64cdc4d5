"""Whether a standard can be made, and how stiff it stands: cutters, first mode, sag.

In: a `Standard`. Out: a `Making` and `making.json`. Neither the CAD kernel nor a mesh is needed:
bodies answer for distances, and plate and pillars are cubes of finite elements.
"""

from matstd.cad_out.making.cutting import Cutting as Cutting
from matstd.cad_out.making.hints import ROUGHNESS as ROUGHNESS
from matstd.cad_out.making.hints import FaceHint as FaceHint
from matstd.cad_out.making.joints import PAD_HEIGHT as PAD_HEIGHT
from matstd.cad_out.making.joints import Block as Block
from matstd.cad_out.making.joints import Joints as Joints
from matstd.cad_out.making.joints import Stud as Stud
from matstd.cad_out.making.joints import joints_if_any as joints_if_any
from matstd.cad_out.making.joints import joints_of as joints_of
from matstd.cad_out.making.making_file import FIRST_MODE as FIRST_MODE
from matstd.cad_out.making.making_file import SAG as SAG
from matstd.cad_out.making.making_file import Making as Making
from matstd.cad_out.making.making_file import making_of as making_of
from matstd.cad_out.making.making_file import write_making as write_making
from matstd.cad_out.making.stiffness import Stiffness as Stiffness
from matstd.cad_out.making.stiffness import stiffness_of as stiffness_of
from matstd.cad_out.making.stiffness import with_sag as with_sag
