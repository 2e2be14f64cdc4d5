"""A plan as the control's programs.

In: a `TouchPlan` and a `Dialect`. Out: a `ProgramSet`, text of programs and masks that the strict
interpreter has read back. What stands in a program, and in which order, is in `writer`.
"""

from matstd.probe_paths.emit.program import (
    SEARCH,
    Program,
    ProgramSet,
    make_ball,
    make_dry_run,
    make_first,
    make_programs,
    make_search,
)
from matstd.probe_paths.emit.writer import Feeds

__all__ = [
    "SEARCH",
    "Feeds",
    "Program",
    "ProgramSet",
    "make_ball",
    "make_dry_run",
    "make_first",
    "make_programs",
    "make_search",
]
