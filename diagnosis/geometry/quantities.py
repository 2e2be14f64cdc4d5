"""Reported quantities of a machine's geometry, each linear in the parameters of a model."""

from collections.abc import Iterator
from dataclasses import dataclass
from enum import Enum

from matstd.diagnosis.fit import Fit
from matstd.twin.frames import Array
from matstd.twin.model import Effect


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


def is_geometry(effect: Effect) -> bool:
    """Whether an effect is a component or location error, a function of readings alone."""
    return effect.kind in ("geometric", "location")


def geometric_effects(fit: Fit) -> Iterator[tuple[int, Effect]]:
    """Geometric effects with the place of their first parameter."""
    start = 0
    for effect in fit.model.effects:
        if is_geometry(effect):
            yield start, effect
        start += len(effect.parameters)
