"""Effects of temperatures and speeds: what follows a drive, at once or with a lag of its own.

A *drive* is a column of the run that something may follow: a temperature, the speed of the spindle,
a column of the user's own. One kind a file, as in `effects`; `drives` lists those of a run.
"""

from matstd.twin.thermal.drive_columns import CYCLE, OWN, PROGRESS, SPINDLE, drives, is_speed
from matstd.twin.thermal.follows import follower
from matstd.twin.thermal.thermal_field import field
from matstd.twin.thermal.thermal_lag import ThermalLag

__all__ = [
    "CYCLE", "OWN", "PROGRESS", "SPINDLE", "ThermalLag", "drives", "field", "follower", "is_speed",
]  # fmt: skip
