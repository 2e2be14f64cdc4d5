"""Tables of other programs and instruments as runs: positioning, circles, points, arms, mappings.

In go workbooks and text as instruments and CMMs write them, with the words of their headers, their
units, separators and decimal marks; out come a `Run` (or its text) and, where no machine file is
given, a machine whose travels are those of the data. The sign of a deviation is decided here, once:
what a machine does wrong is the negative of what its controller sees.

    sheet = read_sheet("laser.xlsx")
    test = read_positioning(sheet, "X")
    run = positioning_run(test, one_axis_machine("X", test.target), u=0.3 * UM)
"""

from matstd.importers.arms import import_arm as import_arm
from matstd.importers.files import import_mapped as import_mapped
from matstd.importers.files import machine_text as machine_text
from matstd.importers.files import with_travels as with_travels
from matstd.importers.instruments import circle_machine as circle_machine
from matstd.importers.instruments import circle_run as circle_run
from matstd.importers.instruments import one_axis_machine as one_axis_machine
from matstd.importers.instruments import positioning_run as positioning_run
from matstd.importers.instruments import read_circle as read_circle
from matstd.importers.instruments import read_positioning as read_positioning
from matstd.importers.points import ScanLog as ScanLog
from matstd.importers.points import import_points as import_points
from matstd.importers.points import read_scan_log as read_scan_log
from matstd.importers.sheets import Sheet as Sheet
from matstd.importers.sheets import read_sheet as read_sheet

PARTS = ("sheets", "instruments", "points", "arms", "files")
"""From bottom to top: each imports only from those before it."""
