"""Reported quantities of a machine's geometry, each linear in the parameters of a model."""

from collections.abc import Callable, Iterator
from dataclasses import dataclass
from enum import Enum

import numpy as np

from matstd.diagnosis.fit import Fit
from matstd.twin.frames import Array
from matstd.twin.model import Effect, traits


class Quantity(Enum):
    """A reported quantity of the geometry of a machine."""

    SCALE = "scale"
    STRAIGHTNESS = "straightness"
    SQUARENESS = "squareness"
    ANGULAR = "angular error"
    ROTARY_LINE = "line of a rotary axis"
    ROTARY_ZERO = "zero of a rotary axis"
    ROTARY_MOTION = "error motion of a rotary axis"
    JOINT_ZERO = "zero of a joint"
    LINK_LENGTH = "length of a link"
    JOINT_OFFSET = "offset along a joint"
    LINK_TWIST = "twist of a link"


@dataclass(frozen=True, slots=True, eq=False)
class Functional:
    """A quantity as weights (P,) of the parameters of the geometric effects."""

    quantity: Quantity
    symbol: str
    axes: tuple[str, ...]
    unit: str
    weights: Array
    lever: float
    # of a peak to valley the curve (N, P), of which the weights are one reading less another
    curve: Array | None = None

    def at(self, theta: Array) -> Array:
        """Weights (P,) of a peak to valley between the peak and valley of these parameters."""
        return self.weights if self.curve is None else peak_to_valley(self.curve, theta)


def peak_to_valley(curve: Array, theta: Array) -> Array:
    """Weights (P,) of the largest less the smallest value of a curve (N, P), mm or rad.

    A curve of which the run says nothing is zero but for rounding, which differs between
    processors; its weights are those of its ends.
    """
    values = np.round(curve @ theta, 12)
    high, low = (int(np.argmax(values)), int(np.argmin(values))) if np.ptp(values) else (-1, 0)
    return np.asarray(curve[high] - curve[low])


def is_geometry(effect: Effect) -> bool:
    """Whether an effect is a component or location error, a function of readings alone."""
    return effect.kind in ("geometric", "location")


def is_of_readings(effect: Effect) -> bool:
    """Whether an effect is a part of such an error: geometry, a table, a law of its own reading.

    A kink that a parabola straightens elsewhere is no error by itself, and neither is the parabola.
    """
    if is_geometry(effect):
        return True
    own = traits(effect)
    return own.is_of_reading or (own.is_table and own.reversal is None)


def geometric_effects(fit: Fit) -> Iterator[tuple[int, Effect]]:
    """Geometric effects with the place of their first parameter."""
    return _placed(fit, is_geometry)


def effects_of_readings(fit: Fit) -> Iterator[tuple[int, Effect]]:
    """The same with tables and laws that are parts of the errors which they are."""
    return _placed(fit, is_of_readings)


def _placed(fit: Fit, is_counted: Callable[[Effect], bool]) -> Iterator[tuple[int, Effect]]:
    start = 0
    for effect in fit.model.effects:
        if is_counted(effect):
            yield start, effect
        start += len(effect.parameters)
