"""Effects of temperatures and speeds: what follows a drive, at once or with a lag of its own.

A *drive* is a column of the run that something may follow: a temperature, the speed of the spindle,
a column of the user's own. One kind a file, as in `effects`; `drives` lists those of a run.
"""

from matstd.twin.thermal.drive_columns import CYCLE as CYCLE
from matstd.twin.thermal.drive_columns import OWN as OWN
from matstd.twin.thermal.drive_columns import PROGRESS as PROGRESS
from matstd.twin.thermal.drive_columns import SPINDLE as SPINDLE
from matstd.twin.thermal.drive_columns import Clock as Clock
from matstd.twin.thermal.drive_columns import clocks as clocks
from matstd.twin.thermal.drive_columns import drives as drives
from matstd.twin.thermal.drive_columns import is_speed as is_speed
from matstd.twin.thermal.drive_columns import own_column as own_column
from matstd.twin.thermal.follows import follower as follower
from matstd.twin.thermal.thermal_field import field as field
from matstd.twin.thermal.thermal_lag import ThermalLag as ThermalLag
