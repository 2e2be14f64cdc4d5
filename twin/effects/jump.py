"""A jump of an axis: counts that were lost, a zero that moved, a collision.

Stated by the user (`--add 'jump(EXX)'`) and never proposed: noise that remembers wanders off at
some instant in every log, and three of four such logs got a false jump.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np

from matstd.twin.machine import Chain, Symbol
from matstd.twin.model import (
    Inner,
    Kind,
    Parameter,
    Term,
    Title,
    check_count,
    component_symbol,
)
from matstd.twin.record import Touches
from matstd.twin.units import UM, URAD

ON_EACH_SIDE = 6
"""Readings before a jump and behind it: fewer are accidents."""
INSTANTS = 600
"""Most instants that are scanned; between two of them the search refines."""


@dataclass(frozen=True)
class Jump:
    """The positioning of an axis is another one from an unknown instant on.

    ``E = a`` after the instant, until the end of the run.

    Attributes:
        instant: s since the start of the run.
    """

    symbol: Symbol
    instant: float = 0.0

    kind = "jump"

    @property
    def name(self) -> str:
        """`jump(EXX)`."""
        return f"jump({self.symbol.name})"

    @property
    def title(self) -> Title:
        """In the words of those who run machines."""
        return Title(f"jump of {self.symbol.link}, as of lost counts", self.symbol.link)

    @property
    def parameters(self) -> Sequence[Parameter]:
        """The height of the step."""
        sd = 30 * URAD if self.symbol.is_angular else 10 * UM
        return (Parameter("amplitude", self.symbol.unit, sd),)

    def terms(self, touches: Touches) -> Sequence[Term]:
        """A twist of the axis."""
        later = (touches.time > self.instant).astype(float)
        return (Term(0, touches.chain.twist_of(self.symbol), later),)

    def inner(self, touches: Touches) -> Sequence[Inner]:
        """Instants between two readings, with enough of them on either side."""
        t = np.unique(touches.time)
        middle = 0.5 * (t[1:] + t[:-1])
        inside = middle[ON_EACH_SIDE - 1 : len(middle) - ON_EACH_SIDE + 1]
        step = int(np.ceil(len(inside) / INSTANTS)) or 1
        return (Inner("instant", "s", inside[::step], acts="at an instant"),)

    def tuned(self, *values: float) -> "Jump":
        """With this instant, s."""
        return replace(self, instant=float(values[0]))

    @property
    def tuning(self) -> Mapping[str, float]:
        """The instant, s."""
        return {"instant": self.instant}


def make(chain: Chain, arguments: Sequence[str]) -> Jump:
    """From the component error."""
    check_count(KIND.usage, arguments, 1, 1)
    return Jump(component_symbol(chain, arguments[0]))


KIND = Kind(
    word="jump",
    arguments="symbol",
    title="jump of an axis",
    synonyms="lost counts, lost steps, missed pulses, reference, shifted zero, collision, slip",
    formula="E = a after an unknown instant",
    units="a: µm or µrad; instant: s",
    typical="whole counts of the encoder, whole steps of a motor, 0.1 to 20 µm",
    source="counting errors of incremental encoders; motors without feedback",
    make=make,
    propose=lambda touches: (),
    classes=(Jump,),
    belongs_to="run",
)
