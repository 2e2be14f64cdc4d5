"""Part programs: read, compensated by the inverse of the exact twin, written.

In: a Klartext or G-code program (`read_part_program`), `MachineErrors` and where the program's zero
stands (`Frame`). Out: `Compensated`: the program's text, and every point as it should be, as the
machine makes it without and with compensation. A new language is a module with `read`, `lines`,
`begin` and `listed`, and its ending in `program`.
"""

from compensation.programs.compensation import TOLERANCE, Compensated, compensated, passed
from compensation.programs.frame import Frame
from compensation.programs.loads import Load, read_loads
from compensation.programs.motion import Arc, Keep, Motion
from compensation.programs.program import Program, read_part_program
from compensation.programs.shares_file import write_shares
from compensation.programs.trajectory_file import write_trajectory

__all__ = [
    "TOLERANCE",
    "Arc",
    "Compensated",
    "Frame",
    "Keep",
    "Load",
    "Motion",
    "Program",
    "compensated",
    "passed",
    "read_loads",
    "read_part_program",
    "write_shares",
    "write_trajectory",
]
