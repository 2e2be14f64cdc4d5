"""Tables of other programs and instruments as runs: positioning, circles, points, arms, mappings.

In go workbooks and text as instruments and CMMs write them, with the words of their headers, their
units, separators and decimal marks; out come a `Run` (or its text) and, where no machine file is
given, a machine whose travels are those of the data. The sign of a deviation is decided here, once:
what a machine does wrong is the negative of what its controller sees.

    sheet = read_sheet("laser.xlsx")
    test = read_positioning(sheet, "X")
    run = positioning_run(test, one_axis_machine("X", test.target), u=0.3 * UM)
"""

from matstd.importers.arms import import_arm
from matstd.importers.files import import_mapped, machine_text, with_travels
from matstd.importers.instruments import (
    circle_machine,
    circle_run,
    one_axis_machine,
    positioning_run,
    read_circle,
    read_positioning,
)
from matstd.importers.points import ScanLog, import_points, read_scan_log
from matstd.importers.sheets import Sheet, read_sheet

PARTS = ("sheets", "instruments", "points", "arms", "files")
"""From bottom to top: each imports only from those before it."""

__all__ = [
    "ScanLog", "Sheet", "circle_machine", "circle_run", "import_arm", "import_mapped",
    "import_points", "machine_text", "one_axis_machine", "positioning_run", "read_circle",
    "read_positioning", "read_scan_log", "read_sheet", "with_travels",
]  # fmt: skip
