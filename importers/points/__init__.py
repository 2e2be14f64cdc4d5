"""Lists of nominal and measured coordinates, of parts and of calibrated plates."""

from matstd.importers.points.point_list import joined_points
from matstd.importers.points.reading import Meaning, read_points
from matstd.importers.points.runs import import_points, linear_machine, points_run
from matstd.importers.points.scan_log import ScanLog, read_scan_log

__all__ = [
    "Meaning", "ScanLog", "import_points", "joined_points",
    "linear_machine", "points_run", "read_points", "read_scan_log",
]  # fmt: skip
