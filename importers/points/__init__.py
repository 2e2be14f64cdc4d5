"""Lists of nominal and measured coordinates, of parts and of calibrated plates."""

from matstd.importers.points.other_frame import in_measured_frame, in_nominal_frame, measured_frames
from matstd.importers.points.point_list import PointList, joined_points, misplaced
from matstd.importers.points.points import linear_machine, points_run, read_points

__all__ = [
    "PointList",
    "in_measured_frame",
    "in_nominal_frame",
    "joined_points",
    "linear_machine",
    "measured_frames",
    "misplaced",
    "points_run",
    "read_points",
]
