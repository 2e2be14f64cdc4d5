"""A jump of an axis: lost counts, a shifted zero, a collision.

The user states it (`--add 'jump(EXX)'`); it is never proposed, because correlated noise wanders off
in every log: three of four such logs got a false jump.
"""

from dataclasses import dataclass

import numpy as np

from matstd.twin.fields import ComponentSymbol, no_values
from matstd.twin.frames import Array
from matstd.twin.model import Amounts, Declared, Kind, scanned
from matstd.twin.record import Touches
from matstd.twin.units import UM, URAD

ON_EACH_SIDE = 6  # readings needed before and after a jump; fewer may be outliers
INSTANTS = 600  # largest number of scanned instants; the search refines between them


def thinned(instants: Array, most: int) -> Array:
    """Instants at even steps, at most `most` of them."""
    return instants[:: int(np.ceil(len(instants) / most)) or 1]


def between(times: Array, on_each_side: int) -> Array:
    """Instants between ascending times, with so many times on either side at least."""
    middle = 0.5 * (times[1:] + times[:-1])
    inside: Array = middle[on_each_side - 1 : len(middle) - on_each_side + 1]
    return inside


@dataclass(frozen=True)
class Jump(Declared):
    """The positioning of an axis is another one from an unknown instant on.

    ``E = a`` after the instant, s since the start of the run, until the end of the run.
    """

    symbol: ComponentSymbol
    instant: float = scanned(
        "s",
        lambda _, touches: thinned(between(np.unique(touches.time), ON_EACH_SIDE), INSTANTS),
        acts="at an instant",
    )

    kind, called = "jump", "jump of {symbol.link}, as of lost counts"
    usual = (10 * UM, 30 * URAD)

    def amounts(self, touches: Touches) -> Amounts:
        return ((touches.time > self.instant).astype(float),)


KIND = Kind.of(
    Jump,
    title="jump of an axis",
    synonyms="lost counts, lost steps, missed pulses, reference, shifted zero, collision, slip",
    formula="E = a after an unknown instant",
    units="a: µm or µrad; instant: s",
    typical="whole counts of the encoder, whole steps of a motor, 0.1 to 20 µm",
    source="counting errors of incremental encoders; motors without feedback",
    propose=no_values,
    belongs_to="run",
)
