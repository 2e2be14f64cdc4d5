"""The library of effects, one kind a file: a class with its formula and a `Kind` that describes it.

A new effect is a new file here and one line in `matstd.twin.library.catalogue`; the exact twin, the
fit, the search and the reports know it from then on.
"""

from matstd.twin.effects.geometric import ComponentError, HigherOrder, component
from matstd.twin.effects.location import LocationError
from matstd.twin.effects.once_more import MARK, Again, Change, again
from matstd.twin.effects.periodic import (
    MOST_OVERTONES,
    Harmonic,
    Overtones,
    Periodic,
    usual_distance,
)
from matstd.twin.effects.position_table import PositionTable
from matstd.twin.effects.probe import ProbeRadius, normal_in_tool
from matstd.twin.effects.setup_error import (
    SHIFT_SD,
    TURN_SD,
    Free,
    StylusError,
    body_errors,
    placing_errors,
    setup_errors,
)

__all__ = [
    "MARK",
    "MOST_OVERTONES",
    "SHIFT_SD",
    "TURN_SD",
    "Again",
    "Change",
    "ComponentError",
    "Free",
    "Harmonic",
    "HigherOrder",
    "LocationError",
    "Overtones",
    "Periodic",
    "PositionTable",
    "ProbeRadius",
    "StylusError",
    "again",
    "body_errors",
    "component",
    "normal_in_tool",
    "placing_errors",
    "setup_errors",
    "usual_distance",
]
