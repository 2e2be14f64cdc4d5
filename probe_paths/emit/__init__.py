"""A plan as the control's programs.

In: a `TouchPlan` and a `Dialect`. Out: a `ProgramSet`, text of programs and masks that the strict
interpreter has read back. What stands in a program, and in which order, is in `writer`.
"""

from matstd.probe_paths.emit.program import SEARCH as SEARCH
from matstd.probe_paths.emit.program import Program as Program
from matstd.probe_paths.emit.program import ProgramSet as ProgramSet
from matstd.probe_paths.emit.program import make_ball as make_ball
from matstd.probe_paths.emit.program import make_dry_run as make_dry_run
from matstd.probe_paths.emit.program import make_first as make_first
from matstd.probe_paths.emit.program import make_programs as make_programs
from matstd.probe_paths.emit.program import make_search as make_search
from matstd.probe_paths.emit.writer import Feeds as Feeds
