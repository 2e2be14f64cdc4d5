"""From a standard to probing programs, and from their logs back to measurements.

In: a standard, a machine, a probe, a set-up and the touches that are wanted (`Requests`).
Out: programs for an iTNC 530 or another control, and from the logs that they leave a `Run`.

    Requests -> plan_touches -> TouchPlan -> make_programs -> ProgramSet (text)
    text -> read_program -> ReadProgram -> simulate (the exact twin) -> logs
    logs, from the twin or from a control -> read_log -> evaluate -> Run

Plan and simulation meet in nothing but the text: what the writer meant is unknown to the reader,
so a slip between the two shows. `linuxcnc` has what runs beside that control, `locate` finds a
standard that stands beside its place and plans again for where it is. Another word of a control
goes into `language`, another rule for what a program may do into `control`, another shape of
program into `emit`.
"""

from matstd.probe_paths.campaign import (
    Campaign,
    VirtualMachine,
    evaluate,
    orders,
    probing_time,
    simulate,
)
from matstd.probe_paths.control import (
    Clock,
    LogPart,
    ReadProgram,
    interpret,
    read_log,
    read_program,
)
from matstd.probe_paths.emit import Feeds, ProgramSet, make_programs
from matstd.probe_paths.language import Dialect
from matstd.probe_paths.plan import PlanOptions, Probe, TouchPlan, plan_touches, requests_at

PARTS = ("plan", "language", "control", "emit", "stations", "campaign", "linuxcnc", "locate")
"""From bottom to top: each imports only from those before it."""

__all__ = [
    "Campaign",
    "Clock",
    "Dialect",
    "Feeds",
    "LogPart",
    "PlanOptions",
    "Probe",
    "ProgramSet",
    "ReadProgram",
    "TouchPlan",
    "VirtualMachine",
    "evaluate",
    "interpret",
    "make_programs",
    "orders",
    "plan_touches",
    "probing_time",
    "read_log",
    "read_program",
    "requests_at",
    "simulate",
]
