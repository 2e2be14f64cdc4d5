"""The control as our programs see it: reader, interpreter, clock and log.

In: the text of a program (`read_program`) or of a log (`read_log`). Out: the steps that the program
takes (`ReadProgram`), and what one run of it logged (`LogPart`). Rules for single blocks are in
`modes` and `motion`, those for a whole program in `structure` and `runner`.
"""

from matstd.probe_paths.control.clock import Clock, step_times
from matstd.probe_paths.control.interpreter import (
    interpret,
    read_program,
    stated_heading,
    stated_probe,
)
from matstd.probe_paths.control.log import BALL, FIRST, UNDATED, LogPart, read_log
from matstd.probe_paths.control.motion import MAX_FEED
from matstd.probe_paths.control.steps import (
    STATUS,
    Halt,
    Move,
    Print,
    ProbeStep,
    ReadProgram,
    Result,
    Step,
    Value,
)

__all__ = [
    "BALL",
    "FIRST",
    "MAX_FEED",
    "STATUS",
    "UNDATED",
    "Clock",
    "Halt",
    "LogPart",
    "Move",
    "Print",
    "ProbeStep",
    "ReadProgram",
    "Result",
    "Step",
    "Value",
    "interpret",
    "read_log",
    "read_program",
    "stated_heading",
    "stated_probe",
    "step_times",
]
