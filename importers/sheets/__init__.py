"""Tables of others as they come: workbooks, text, logs, height maps, with units and clocks.

Nothing is known here of machines: a `Sheet` has columns of text and numbers, the units that stand
behind their names, and the line of every row; what they mean is decided by the parts above.
"""

from matstd.importers.sheets.clock import TIME as TIME
from matstd.importers.sheets.clock import clock_times as clock_times
from matstd.importers.sheets.clock import has_clock as has_clock
from matstd.importers.sheets.clock import seconds as seconds
from matstd.importers.sheets.directions import approaches as approaches
from matstd.importers.sheets.directions import sign_of as sign_of
from matstd.importers.sheets.directions import signs as signs
from matstd.importers.sheets.directions import strokes as strokes
from matstd.importers.sheets.rows import timed_by_rows as timed_by_rows
from matstd.importers.sheets.sensors import loads as loads
from matstd.importers.sheets.sensors import own_columns as own_columns
from matstd.importers.sheets.sensors import temperatures as temperatures
from matstd.importers.sheets.sheet import Sheet as Sheet
from matstd.importers.sheets.table import listed_tables as listed_tables
from matstd.importers.sheets.table import most_read as most_read
from matstd.importers.sheets.table import read_sheet as read_sheet
from matstd.importers.sheets.table import read_tables as read_tables
from matstd.importers.sheets.units import ANGLES as ANGLES
from matstd.importers.sheets.units import MM as MM
from matstd.importers.sheets.units import bare as bare
from matstd.importers.sheets.units import unit_of_column as unit_of_column
