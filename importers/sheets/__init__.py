"""Tables of others as they come: workbooks, text, logs, height maps, with units and clocks.

Nothing is known here of machines: a `Sheet` has columns of text and numbers, the units that stand
behind their names, and the line of every row; what they mean is decided by the parts above.
"""

from matstd.importers.sheets.clock import TIME, clock_times, has_clock, seconds
from matstd.importers.sheets.directions import approaches, sign_of, signs, strokes
from matstd.importers.sheets.rows import timed_by_rows
from matstd.importers.sheets.sensors import loads, own_columns, temperatures
from matstd.importers.sheets.sheet import Sheet
from matstd.importers.sheets.table import listed_tables, most_read, read_sheet, read_tables
from matstd.importers.sheets.units import ANGLES, MM, bare, unit_of_column

__all__ = [
    "ANGLES", "MM", "TIME", "Sheet", "approaches", "bare", "clock_times", "has_clock",
    "listed_tables", "loads", "most_read", "own_columns", "read_sheet", "read_tables", "seconds",
    "sign_of", "signs", "strokes", "temperatures", "timed_by_rows", "unit_of_column",
]  # fmt: skip
