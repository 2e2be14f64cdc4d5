"""Location errors of axes, and the set-up errors of the workpiece and the tool: constants."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from twin.effect import Parameter, Term, Where
from twin.symbols import Symbol
from twin.touches import Touches


@dataclass(frozen=True)
class LocationError:
    """A constant displacement of an axis's line, of its zero, of the workpiece or of the tool.

    The chain knows how it reaches the tip (`twin.kinematics.place_as_twist`): a squareness turns
    the direction of travel of a linear axis, `EX0C`, `EA0C` displace and tilt a rotary axis's
    line, `EX0X`, `EC0C` add to a reading. One parameter, mm or rad.

    Attributes:
        symbol: Which one.
        sd: Expected standard deviation, mm or rad.

    Reference:
        ISO 230-1:2012 (location errors); ISO 230-7 (axes of rotation).
    """

    symbol: Symbol
    sd: float = 1.0

    kind = "location"

    @property
    def name(self) -> str:
        """`location(EC0Y)`."""
        return f"location({self.symbol.name})"

    @property
    def parameters(self) -> Sequence[Parameter]:
        """The constant."""
        return (Parameter("amplitude", "rad" if self.symbol.is_angular else "mm", self.sd),)

    def terms(self, touches: Touches) -> Sequence[Term]:
        """A displacement of the link."""
        i = touches.chain.link_index(self.symbol.link)
        return (Term(0, Where("place", i, self.symbol.component), np.ones(len(touches))),)
