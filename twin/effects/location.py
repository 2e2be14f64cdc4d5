"""Location errors of axes, and the set-up errors of the workpiece and the tool: constants."""

from collections.abc import Iterable, Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from typing import Self

import numpy as np

from matstd.twin.fields import AnySymbol, Refuse
from matstd.twin.machine import Chain, Family, Ranges
from matstd.twin.model import Amounts, Declared, Kind, Parameter, Where
from matstd.twin.record import Touches


@dataclass(frozen=True)
class LocationError(Declared):
    """A constant displacement of an axis's line, of its zero, of the workpiece or of the tool.

    The chain knows how it reaches the tip (`matstd.twin.machine.kinematics.place_as_twist`): a
    squareness turns the direction of travel of a linear axis, `EX0C`, `EA0C` displace and tilt a
    rotary axis's line, `EX0X`, `EC0C` add to a reading.
    """

    symbol: AnySymbol
    sd: float = 1.0  # expected standard deviation, mm or rad

    kind, called = "location", "{symbol.title}"
    is_ordinary = True

    def on(self, chain: Chain, refuse: Refuse) -> Self:
        """With the prior of the default ranges; raises for a component error."""
        if self.symbol.family is Family.COMPONENT:
            names = [s.name for s in chain.symbols if s.family is not Family.COMPONENT]
            raise refuse(f"one of {', '.join(names)}")
        return replace(self, sd=Ranges().sd(chain, self.symbol))

    @cached_property
    def parameters(self) -> Sequence[Parameter]:
        return (Parameter("amplitude", self.symbol.unit, self.sd),)

    def where(self, chain: Chain) -> Where:
        return Where("place", chain.link_index(self.symbol.link), self.symbol.component)

    def amounts(self, touches: Touches) -> Amounts:
        return (np.ones(len(touches)),)


def propose(touches: Touches) -> Iterable[LocationError]:
    """Every location error; the set-ups of workpiece and tool are constants of the run."""
    for symbol in touches.chain.symbols:
        if symbol.family is Family.LOCATION:
            yield LocationError(symbol, Ranges().sd(touches.chain, symbol))


KIND = Kind.of(
    LocationError,
    title="squareness and place of axes",
    synonyms="perpendicularity, parallelism, pivot point, centre of rotation, rotary "
    "axis centre, RTCP offset, kinematic offset, axis alignment",
    formula="E = a, constant: squareness, line of a rotary axis, zero position, set-up",
    units="a: µm or µrad",
    typical="20 to 100 µm, 20 to 100 µrad when neglected; 2 to 10 µm, 10 to 30 µrad after care",
    source="ISO 230-1:2012 (location errors); ISO 230-7 (axes of rotation)",
    propose=propose,
)
