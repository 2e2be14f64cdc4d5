"""Part programs: read into motions, written again.

In: a Klartext or G-code program (`read_part_program`) and where its zero stands (`Frame`). Out:
`Program`: its blocks in their order, every motion with the places of all axes. A new language is
a reader and a module that writes (`lines`, `comment`, `begin`, `listed`), and both in `program`.
"""

from matstd.compensation.part_programs.frame import Frame
from matstd.compensation.part_programs.motion import Keep, Motion, Paths
from matstd.compensation.part_programs.program import Program, forces, read_loads, read_part_program

__all__ = [
    "Frame",
    "Keep",
    "Motion",
    "Paths",
    "Program",
    "forces",
    "read_loads",
    "read_part_program",
]
