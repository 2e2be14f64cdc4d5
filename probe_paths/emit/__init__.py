"""A plan as the control's programs."""

from probe_paths.emit.program import ProgramSet, make_programs
from probe_paths.emit.writer import Feeds

__all__ = ["Feeds", "ProgramSet", "make_programs"]
