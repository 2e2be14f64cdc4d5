"""The library of effects, one kind a file: a class with its formula and a `Kind` that describes it.

A new effect is a new file here and one line in `matstd.twin.library.catalogue`; the exact twin, the
fit, the search and the reports know it from then on.
"""

from matstd.twin.effects.geometric import ComponentError, HigherOrder, component
from matstd.twin.effects.location import LocationError
from matstd.twin.effects.periodic import MAX_OVERTONES, usual_distance
from matstd.twin.effects.probe import ProbeRadius, normal_in_tool
from matstd.twin.effects.repeated import MARK, Change, Repeated, repeat
from matstd.twin.effects.setup_error import (
    SHIFT_SD,
    TURN_SD,
    Free,
    body_errors,
    further_styli,
    placing_errors,
    setup_errors,
)

__all__ = [
    "MARK", "MAX_OVERTONES", "SHIFT_SD", "TURN_SD", "Change", "ComponentError", "Free",
    "HigherOrder", "LocationError", "ProbeRadius", "Repeated", "body_errors", "component",
    "further_styli", "normal_in_tool", "placing_errors", "repeat", "setup_errors",
    "usual_distance",
]  # fmt: skip
