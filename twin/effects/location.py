"""Location errors of axes, and the set-up errors of the workpiece and the tool: constants."""

from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from matstd.twin.machine import Chain, Family, Ranges, Symbol
from matstd.twin.model import Kind, Parameter, Term, Title, Where, check_count, refusal
from matstd.twin.record import Touches


@dataclass(frozen=True)
class LocationError:
    """A constant displacement of an axis's line, of its zero, of the workpiece or of the tool.

    The chain knows how it reaches the tip (`matstd.twin.machine.kinematics.place_as_twist`): a
    squareness turns the direction of travel of a linear axis, `EX0C`, `EA0C` displace and tilt a
    rotary axis's line, `EX0X`, `EC0C` add to a reading.

    Attributes:
        symbol: Which one.
        sd: Expected standard deviation, mm or rad.
    """

    symbol: Symbol
    sd: float = 1.0

    kind = "location"

    @property
    def name(self) -> str:
        """`location(EC0Y)`."""
        return f"location({self.symbol.name})"

    @property
    def title(self) -> Title:
        """In the words of those who run machines."""
        return Title(self.symbol.title, self.symbol.link)

    @cached_property
    def parameters(self) -> Sequence[Parameter]:
        """The constant."""
        return (Parameter("amplitude", self.symbol.unit, self.sd),)

    def terms(self, touches: Touches) -> Sequence[Term]:
        """A displacement of the link."""
        i = touches.chain.link_index(self.symbol.link)
        return (Term(0, Where("place", i, self.symbol.component), np.ones(len(touches))),)


def make(chain: Chain, arguments: Sequence[str]) -> LocationError:
    """From the name of the constant, with the prior of the default ranges."""
    check_count(KIND.usage, arguments, 1, 1)
    symbol = chain.symbol(arguments[0])
    if symbol.family is Family.COMPONENT:
        names = [s.name for s in chain.symbols if s.family is not Family.COMPONENT]
        raise refusal(KIND.usage, arguments, f"one of {', '.join(names)}")
    return LocationError(symbol, Ranges().sd(chain, symbol))


def propose(touches: Touches) -> Iterable[LocationError]:
    """Every location error; the set-ups of workpiece and tool are constants of the run."""
    for symbol in touches.chain.symbols:
        if symbol.family is Family.LOCATION:
            yield LocationError(symbol, Ranges().sd(touches.chain, symbol))


KIND = Kind(
    word="location",
    arguments="symbol",
    title="squareness and place of axes",
    synonyms="perpendicularity, parallelism, pivot point, centre of rotation, rotary "
    "axis centre, RTCP offset, kinematic offset, axis alignment",
    formula="E = a, constant: squareness, line of a rotary axis, zero position, set-up",
    units="a: µm or µrad",
    typical="20 to 100 µm, 20 to 100 µrad when neglected; 2 to 10 µm, 10 to 30 µrad after care",
    source="ISO 230-1:2012 (location errors); ISO 230-7 (axes of rotation)",
    make=make,
    propose=propose,
    classes=(LocationError,),
)
