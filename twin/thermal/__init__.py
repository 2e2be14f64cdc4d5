"""Effects of temperatures and speeds: what follows a drive, at once or with a lag of its own.

A *drive* is a column of the run that something may follow: a temperature, the speed of the spindle,
a column of the user's own. One kind a file, as in `effects`; `drives` says what drives a run has.
"""

from twin.thermal.drive_columns import drives, is_speed
from twin.thermal.thermal_field import LETTERS, ThermalField, field
from twin.thermal.thermal_lag import SPINDLE, ThermalLag
from twin.thermal.thermal_static import ThermalStatic

__all__ = [
    "LETTERS",
    "SPINDLE",
    "ThermalField",
    "ThermalLag",
    "ThermalStatic",
    "drives",
    "field",
    "is_speed",
]
