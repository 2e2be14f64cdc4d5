"""Tables of others as they come: workbooks, text, logs, height maps, with units and clocks.

Nothing is known here of machines: a `Sheet` has columns of text and numbers, the units that stand
behind their names, and the line of every row; what they mean is decided by the parts above.
"""

from matstd.importers.sheets.clock import clock_times, has_clock, seconds
from matstd.importers.sheets.sheet import (
    ANGLES,
    MM,
    SECONDS,
    Sheet,
    bare,
    is_unit,
    read_sheet,
    unit_of_column,
)

__all__ = [
    "ANGLES",
    "MM",
    "SECONDS",
    "Sheet",
    "bare",
    "clock_times",
    "has_clock",
    "is_unit",
    "read_sheet",
    "seconds",
    "unit_of_column",
]
