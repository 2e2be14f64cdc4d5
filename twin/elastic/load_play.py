"""Play of an axis under a load that reverses, and its compliance that differs by direction."""

from collections.abc import Iterable, Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from typing import Self

import numpy as np

from matstd.twin.elastic.stiffness import recorded_force
from matstd.twin.fields import AxisName, Refuse, moving_axes
from matstd.twin.frames import Array
from matstd.twin.machine import Chain
from matstd.twin.model import Amounts, Declared, Kind, Parameter
from matstd.twin.record import Touches
from matstd.twin.units import UM


@dataclass(frozen=True)
class LoadPlay(Declared):
    """An axis that stands elsewhere under push than under pull, beside its compliance.

    ``E = (P/2) sgn F + (D/2) |F|``, F the load along a linear axis or its moment about a rotary
    one: a play P, and by how much the compliance under a positive load exceeds that under a
    negative one, D. `stiffness` has their mean. Nothing acts without a load.
    """

    axis: AxisName
    component: int = 0  # index of the component along or about the axis

    kind, called = "load-play", "play of {axis} under load"
    is_by_parameter = True

    def on(self, chain: Chain, refuse: Refuse) -> Self:
        """With the component of the axis."""
        return replace(self, component=chain.link(self.axis).own_component)

    @property
    def is_angular(self) -> bool:
        """Whether the axis turns."""
        return self.component >= 3

    @cached_property
    def parameters(self) -> Sequence[Parameter]:
        if self.is_angular:
            return (
                Parameter("play", "rad", 1e-5),
                Parameter("difference of compliance", "rad/(N mm)", 1e-9),
            )
        return (
            Parameter("play", "mm", 5 * UM),
            Parameter("difference of compliance", "mm/N", 0.1 * UM),
        )

    def amounts(self, touches: Touches) -> Amounts:
        load = load_of(touches, self.axis, self.name)
        return (0.5 * np.sign(load), 0.5 * np.abs(load))


def load_of(touches: Touches, axis: str, name: str) -> Array:
    """Load along an axis, N, or its moment about a rotary one, N mm, (N,)."""
    force = recorded_force(touches, name)
    link = touches.chain.link_index(axis)
    own = touches.chain.link(axis).own_component
    return np.asarray(np.einsum("ni,ni->n", touches.reach.twist[:, link, own], force))


def propose(touches: Touches) -> Iterable[LoadPlay]:
    """Every axis that moved and was loaded in both directions."""
    if touches.force is None:
        return
    for axis in moving_axes(touches):
        load = load_of(touches, axis, "load-play")
        if np.any(load > 0.0) and np.any(load < 0.0):
            yield LoadPlay(axis, touches.chain.link(axis).own_component)


KIND = Kind.of(
    LoadPlay,
    title="play under a load that reverses",
    synonyms="clearance, backlash under load, asymmetric stiffness, hysteresis under load, push "
    "and pull",
    formula="E = (P/2) sgn F + (D/2) |F|; F the load along the axis, or its moment about it",
    units="P: µm, µrad; D: µm/N, µrad/(N mm)",
    typical="1 to 10 µm of worn nuts and gears; 0 of preloaded ones",
    source="ISO 230-1 (machine under load); static hysteresis tests of feed axes",
    propose=propose,
)
