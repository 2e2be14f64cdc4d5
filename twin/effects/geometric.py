"""Component errors of an axis as functions of its own reading."""

from collections.abc import Sequence
from dataclasses import dataclass

from twin.chain import Chain
from twin.effect import Parameter, Term, Where
from twin.shapes import ShapeName, shape
from twin.symbols import Symbol
from twin.touches import Touches


@dataclass(frozen=True)
class ComponentError:
    """One component error of an axis in one of the distributions of the D-MT paper.

    ``E(q) = a f(q)`` with f the constant, linear, parabolic or sinusoidal shape of unit peak
    amplitude (`twin.shapes`). One parameter, the peak amplitude, mm or rad.

    Attributes:
        symbol: Which component of which axis.
        shape: Distribution over the reading.
        periods: Of the sinusoidal distribution.
        phase: Of the sinusoidal distribution, rad.
        sd: Expected standard deviation of the amplitude, mm or rad.

    Reference:
        ISO 230-1:2012 (component errors).
    """

    symbol: Symbol
    shape: ShapeName
    periods: float = 1.0
    phase: float = 0.0
    sd: float = 1.0

    kind = "geometric"

    @property
    def name(self) -> str:
        """`geometric(EXX,linear)`; the phase of a sine is told in degrees where it is not zero."""
        extra = f",{self.periods:g}" if self.periods != 1.0 else ""
        extra += f"@{self.phase:.6g}" if self.phase else ""
        return f"geometric({self.symbol.name},{self.shape}{extra})"

    @property
    def parameters(self) -> Sequence[Parameter]:
        """The peak amplitude."""
        return (Parameter("amplitude", "rad" if self.symbol.is_angular else "mm", self.sd),)

    def terms(self, touches: Touches) -> Sequence[Term]:
        """A twist of the axis."""
        i = touches.chain.link_index(self.symbol.link)
        amount = shape(
            self.shape,
            touches.reading(self.symbol.link),
            touches.chain.links[i],
            self.periods,
            self.phase,
        )
        return (Term(0, Where("twist", i, self.symbol.component), amount),)


def component(chain: Chain, name: str, shape: ShapeName, **options: float) -> ComponentError:
    """Component error by its name; raises UnknownSymbol."""
    return ComponentError(chain.symbol(name), shape, **options)
