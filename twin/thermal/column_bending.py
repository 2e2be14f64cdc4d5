"""Bending of a column that is warmer on one side than on the other."""

from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from itertools import combinations

import numpy as np

from matstd.twin.machine import Chain
from matstd.twin.model import (
    Kind,
    Parameter,
    Term,
    Title,
    Where,
    check_count,
    checked_linear,
    moving_axes,
    refusal,
    sensor_record,
    sensors,
)
from matstd.twin.record import Touches
from matstd.twin.units import URAD


@dataclass(frozen=True)
class ColumnBending:
    """A column bends away from its warm side, more the higher the carriage stands on it.

    L is the travel. The carriage turns by E_r and moves across by E_e, for the bending about
    either axis across the column. Holds for a linear gradient over the depth h of the column,
    ``a = alpha L/h``.

    Attributes:
        axis: Linear axis that travels along the column.
        warm: Sensor on one side.
        cold: Sensor on the other.
        component: Index of the component along the axis.
    """

    axis: str
    warm: str
    cold: str
    component: int

    kind = "column-bending"

    @property
    def name(self) -> str:
        """`column-bending(Z,columnLeft,columnRight)`."""
        return f"column-bending({self.axis},{self.warm},{self.cold})"

    @property
    def _across(self) -> tuple[int, int]:
        return (self.component + 1) % 3, (self.component + 2) % 3

    @property
    def title(self) -> Title:
        """In the words of those who run machines."""
        return Title(f"bending of the column of {self.axis}", self.axis)

    @property
    def parameters(self) -> Sequence[Parameter]:
        """Rotation at full height, per kelvin, about the two axes across."""
        names = ("XYZ"[i] for i in self._across)
        return tuple(Parameter(f"about {name}", "rad/K", 20 * URAD) for name in names)

    def terms(self, touches: Touches) -> Sequence[Term]:
        """Twists of the axis: the rotation r, and its integral along the column, r x d."""
        i = touches.chain.link_index(self.axis)
        low, high = touches.chain.links[i].range
        height = (touches.reading(self.axis) - low) / (high - low)
        gradient = sensor_record(touches, self.warm) - sensor_record(touches, self.cold)
        along = np.eye(3)[self.component]
        out = []
        for k, about in enumerate(self._across):
            moved = np.cross(np.eye(3)[about], along)
            straightness = int(np.argmax(np.abs(moved)))
            sag = 0.5 * (high - low) * height**2 * moved[straightness]
            out.append(Term(k, Where("twist", i, 3 + about), gradient * height))
            out.append(Term(k, Where("twist", i, straightness), gradient * sag))
        return tuple(out)


def make(chain: Chain, arguments: Sequence[str]) -> ColumnBending:
    """From the linear axis and a sensor on either side of its column."""
    check_count(KIND.usage, arguments, 3, 3)
    axis = checked_linear(KIND.usage, arguments, arguments[0], chain)
    if arguments[1] == arguments[2]:
        raise refusal(KIND.usage, arguments, "two different sensors")
    return ColumnBending(axis, arguments[1], arguments[2], chain.link(axis).own_component)


def propose(touches: Touches) -> Iterable[ColumnBending]:
    """Every linear axis that moved, with pairs of sensors that are named for a column.

    A gradient needs two sensors on the same body; only their names tell.
    """
    on_column = [s for s in sensors(touches) if s.lower().startswith("column")]
    for axis in moving_axes(touches):
        if axis in touches.chain.linear_axes:
            for warm, cold in combinations(on_column, 2):
                yield ColumnBending(axis, warm, cold, touches.chain.link(axis).own_component)


KIND = Kind(
    word="column-bending",
    arguments="axis,sensor,sensor",
    title="thermal bending of the column",
    synonyms="thermal drift of the column, column tilt, temperature gradient, one-sided heating",
    formula="E_r = a (T_1 - T_2) s, E_e = a (T_1 - T_2) L s^2/2; s = (q - q_min)/L",
    units="a: µrad/K",
    typical="2 to 15 µrad/K; 12 arcsec from 4 K",
    source="J. S. Chen 1995; curvature alpha (T_1 - T_2)/h of a bar with a gradient",
    make=make,
    propose=propose,
    classes=(ColumnBending,),
)
