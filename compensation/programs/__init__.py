"""Part programs compensated by the inverse of the exact twin.

In: a `Program` that was read, and `MachineErrors`. Out: `Compensated`: the program's text, and
every point as it should be, as the machine makes it without and with compensation.
"""

from matstd.compensation.programs.compensation import TOLERANCE as TOLERANCE
from matstd.compensation.programs.compensation import Compensated as Compensated
from matstd.compensation.programs.compensation import compensated as compensated
from matstd.compensation.programs.compensation import passed as passed
from matstd.compensation.programs.result_files import write_program_result as write_program_result
from matstd.compensation.programs.result_files import write_shares as write_shares
from matstd.compensation.programs.result_files import write_trajectory as write_trajectory
