"""Lists of nominal and measured coordinates, of parts and of calibrated plates."""

from matstd.importers.points.point_list import joined_points as joined_points
from matstd.importers.points.reading import Meaning as Meaning
from matstd.importers.points.reading import read_points as read_points
from matstd.importers.points.runs import import_points as import_points
from matstd.importers.points.runs import linear_machine as linear_machine
from matstd.importers.points.runs import points_run as points_run
from matstd.importers.points.scan_log import ScanLog as ScanLog
from matstd.importers.points.scan_log import read_scan_log as read_scan_log
