"""The library of effects, one kind a file."""

from twin.effects.geometric import ComponentError, HigherOrder, component
from twin.effects.location import LocationError
from twin.effects.probe import normal_in_tool
from twin.effects.setup_error import setup_errors
from twin.effects.thermal_lag import SPINDLE, ThermalLag

__all__ = [
    "SPINDLE",
    "ComponentError",
    "HigherOrder",
    "LocationError",
    "ThermalLag",
    "component",
    "normal_in_tool",
    "setup_errors",
]
