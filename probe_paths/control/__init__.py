"""The control as our programs see it: reader, interpreter, clock and log.

In: the text of a program (`read_program`) or of a log (`read_log`). Out: the steps that the program
takes (`ReadProgram`), and what one run of it logged (`LogPart`). Rules for single blocks are in
`modes` and `motion`, those for a whole program in `structure` and `runner`.
"""

from matstd.probe_paths.control.clock import Clock as Clock
from matstd.probe_paths.control.clock import step_times as step_times
from matstd.probe_paths.control.interpreter import interpret as interpret
from matstd.probe_paths.control.interpreter import read_program as read_program
from matstd.probe_paths.control.interpreter import stated_heading as stated_heading
from matstd.probe_paths.control.interpreter import stated_probe as stated_probe
from matstd.probe_paths.control.log import BALL as BALL
from matstd.probe_paths.control.log import FIRST as FIRST
from matstd.probe_paths.control.log import UNDATED as UNDATED
from matstd.probe_paths.control.log import LogPart as LogPart
from matstd.probe_paths.control.log import read_log as read_log
from matstd.probe_paths.control.motion import MAX_FEED as MAX_FEED
from matstd.probe_paths.control.steps import STATUS as STATUS
from matstd.probe_paths.control.steps import Halt as Halt
from matstd.probe_paths.control.steps import Move as Move
from matstd.probe_paths.control.steps import Print as Print
from matstd.probe_paths.control.steps import ProbeStep as ProbeStep
from matstd.probe_paths.control.steps import ReadProgram as ReadProgram
from matstd.probe_paths.control.steps import Result as Result
from matstd.probe_paths.control.steps import Step as Step
from matstd.probe_paths.control.steps import Value as Value
