"""Part programs compensated by the inverse of the exact twin.

In: a `Program` that was read, and `MachineErrors`. Out: `Compensated`: the program's text, and
every point as it should be, as the machine makes it without and with compensation.
"""

from matstd.compensation.programs.compensation import TOLERANCE, Compensated, compensated, passed
from matstd.compensation.programs.result_files import (
    write_program_result,
    write_shares,
    write_trajectory,
)

__all__ = [
    "TOLERANCE",
    "Compensated",
    "compensated",
    "passed",
    "write_program_result",
    "write_shares",
    "write_trajectory",
]
