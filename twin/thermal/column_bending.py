"""Bending of a column that is warmer on one side than on the other."""

from collections.abc import Iterable, Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from itertools import combinations
from typing import Self

import numpy as np

from matstd.twin.fields import (
    LinearAxisName,
    Refuse,
    SensorName,
    moving_linear_axes,
    sensor_record,
    sensors,
)
from matstd.twin.machine import Chain
from matstd.twin.model import Declared, Kind, Parameter, Term, Where
from matstd.twin.record import Touches
from matstd.twin.units import URAD


@dataclass(frozen=True)
class ColumnBending(Declared):
    """A column bends away from its warm side, more the higher the carriage stands on it.

    L is the travel. The carriage turns by E_r and moves across by E_e, for the bending about
    either axis across the column. Holds for a linear gradient over the depth h of the column,
    ``a = alpha L/h``.
    """

    axis: LinearAxisName  # linear axis that travels along the column
    warm: SensorName  # sensor on one side
    cold: SensorName  # sensor on the other
    component: int = 2  # index of the component along the axis

    kind, called = "column-bending", "bending of the column of {axis}"

    def on(self, chain: Chain, refuse: Refuse) -> Self:
        """With the direction of the axis; raises for one sensor on both sides."""
        if self.warm == self.cold:
            raise refuse("two different sensors")
        return replace(self, component=chain.link(self.axis).own_component)

    @property
    def driver(self) -> str:
        """The sensor on its warm side."""
        return self.warm

    @property
    def _across(self) -> tuple[int, int]:
        return (self.component + 1) % 3, (self.component + 2) % 3

    @cached_property
    def parameters(self) -> Sequence[Parameter]:
        names = ("XYZ"[i] for i in self._across)
        return tuple(Parameter(f"about {name}", "rad/K", 20 * URAD) for name in names)

    def terms(self, touches: Touches) -> Sequence[Term]:
        """Twists of the axis: the rotation r, and its integral along the column, r x d."""
        i = touches.chain.link_index(self.axis)
        link = touches.chain.links[i]
        low, high = link.range
        height = (touches.reading(self.axis) - low) / (high - low)
        gradient = sensor_record(touches, self.warm) - sensor_record(touches, self.cold)
        along = link.sense * np.eye(3)[self.component]
        out = []
        for k, about in enumerate(self._across):
            moved = np.cross(np.eye(3)[about], along)
            straightness = int(np.argmax(np.abs(moved)))
            sag = 0.5 * (high - low) * height**2 * moved[straightness]
            out.append(Term(k, Where("twist", i, 3 + about), gradient * height))
            out.append(Term(k, Where("twist", i, straightness), gradient * sag))
        return tuple(out)


def propose(touches: Touches) -> Iterable[ColumnBending]:
    """Every linear axis that moved, with pairs of sensors that are named for a column.

    A gradient needs two sensors on the same body, which only their names show.
    """
    on_column = [s for s in sensors(touches) if s.lower().startswith("column")]
    for axis in moving_linear_axes(touches):
        for warm, cold in combinations(on_column, 2):
            yield ColumnBending(axis, warm, cold, touches.chain.link(axis).own_component)


KIND = Kind.of(
    ColumnBending,
    title="thermal bending of the column",
    synonyms="thermal drift of the column, column tilt, temperature gradient, one-sided heating",
    formula="E_r = a (T_1 - T_2) s, E_e = a (T_1 - T_2) L s^2/2; s = (q - q_min)/L",
    units="a: µrad/K",
    typical="2 to 15 µrad/K; 12 arcsec from 4 K",
    source="J. S. Chen 1995; curvature alpha (T_1 - T_2)/h of a bar with a gradient",
    propose=propose,
)
