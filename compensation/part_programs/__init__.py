"""Part programs: read into motions, written again.

In: a Klartext or G-code program (`read_part_program`) and where its zero stands (`Frame`). Out:
`Program`: its blocks in their order, every motion with the places of all axes. A new language is
a reader and a module that writes (`lines`, `comment`, `begin`, `listed`), and both in `program`.
"""

from matstd.compensation.part_programs.frame import Frame as Frame
from matstd.compensation.part_programs.motion import Keep as Keep
from matstd.compensation.part_programs.motion import Motion as Motion
from matstd.compensation.part_programs.motion import Paths as Paths
from matstd.compensation.part_programs.program import Program as Program
from matstd.compensation.part_programs.program import forces as forces
from matstd.compensation.part_programs.program import read_loads as read_loads
from matstd.compensation.part_programs.program import read_part_program as read_part_program
