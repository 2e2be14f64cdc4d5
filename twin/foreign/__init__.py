"""Tables of others made runs: positioning, circles, points, arms, any other by a mapping.

In go workbooks and text as instruments and CMMs write them, with the words of their headers, their
units, separators and decimal marks; out come a `Run` (or its text) and, where no machine file is
there, a machine whose travels are those of the data. The sign of a deviation is decided here, once,
and said to the user: what a machine did wrong is the negative of what its controller sees.
"""

from matstd.twin.foreign.acceptance import positioning_figures
from matstd.twin.foreign.arm_mistakes import coupled, likely_mistake
from matstd.twin.foreign.axis_run import one_axis_machine, positioning_run
from matstd.twin.foreign.circle import circle_machine, circle_run, read_circle
from matstd.twin.foreign.machine_draft import machine_text
from matstd.twin.foreign.mapping_file import mapped_run
from matstd.twin.foreign.other_frame import in_measured_frame, in_nominal_frame, measured_frames
from matstd.twin.foreign.point_list import joined_points, misplaced
from matstd.twin.foreign.points import linear_machine, points_run, read_points
from matstd.twin.foreign.positioning import PositioningTest, read_positioning
from matstd.twin.foreign.serial_arm import arm_from_dh, joint_readings, misfit, tracker_run

__all__ = [
    "PositioningTest",
    "arm_from_dh",
    "circle_machine",
    "circle_run",
    "coupled",
    "in_measured_frame",
    "in_nominal_frame",
    "joined_points",
    "joint_readings",
    "likely_mistake",
    "linear_machine",
    "machine_text",
    "mapped_run",
    "measured_frames",
    "misfit",
    "misplaced",
    "one_axis_machine",
    "points_run",
    "positioning_figures",
    "positioning_run",
    "read_circle",
    "read_points",
    "read_positioning",
    "tracker_run",
]
