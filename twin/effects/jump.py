"""A jump of an axis: lost counts, a shifted zero, a collision.

In a log the user states it (`--add 'jump(EXX)'`); it is not proposed, because correlated noise
wanders off in every log: three of four got a false jump. In a test without times, whose few cycles
repeat all targets, it stands beside the growth that it would pass for.
"""

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Self

import numpy as np

from matstd.twin.fields import ComponentSymbol, changing_components
from matstd.twin.frames import Array
from matstd.twin.model import Amounts, Declared, Inner, Kind
from matstd.twin.record import Touches
from matstd.twin.thermal import OWN, Clock, clocks, own_column
from matstd.twin.units import UM, URAD

ON_EACH_SIDE = 6  # readings needed before and after a jump; fewer may be outliers
INSTANTS = 600  # largest number of scanned instants; the search refines between them


def thinned(instants: Array, most: int) -> Array:
    """Instants at even steps, at most `most` of them."""
    return instants[:: int(np.ceil(len(instants) / most)) or 1]


def between(times: Array, on_each_side: int) -> Array:
    """Instants between ascending times, with so many times on either side at least."""
    middle = 0.5 * (times[1:] + times[:-1])
    return middle[on_each_side - 1 : len(middle) - on_each_side + 1]


@dataclass(frozen=True)
class Jump(Declared):
    """The positioning of an axis is another one from an unknown instant on.

    ``E = a`` after the instant, s since the start of the run, until the end of the run. In a test
    without times the instant counts cycles that were done.
    """

    symbol: ComponentSymbol
    clock: Clock = ""
    instant: float = 0.0  # s, or in units of the clock

    kind, called = "jump", "jump of {symbol.link}, as of lost counts"
    usual = (10 * UM, 30 * URAD)

    def amounts(self, touches: Touches) -> Amounts:
        return ((self._now(touches) > self.instant).astype(float),)

    def inner(self, touches: Touches) -> Sequence[Inner]:
        """The instant, between readings with enough others on either side."""
        (name,), unit = self.tuning, "1" if self.clock else "s"
        times = between(np.unique(self._now(touches)), ON_EACH_SIDE)
        clock = self.clock.removeprefix(OWN)
        return (Inner(name, unit, thinned(times, INSTANTS), acts="at an instant", clock=clock),)

    def _now(self, touches: Touches) -> Array:
        """Time, or what counts it, at every touch, (N,)."""
        return own_column(touches, self.clock.removeprefix(OWN)) if self.clock else touches.time

    def tuned(self, *values: float) -> Self:
        return replace(self, instant=float(values[0]))

    @property
    def tuning(self) -> Mapping[str, float]:
        return {"cycles_done" if self.clock else "instant": self.instant}


def propose(touches: Touches) -> Iterable[Jump]:
    """Every component of an axis that moved in a test without times, whose cycles come again."""
    for clock in filter(None, clocks(touches)):
        for symbol in changing_components(touches):
            yield Jump(symbol, clock)


KIND = Kind.of(
    Jump,
    title="jump of an axis",
    synonyms="lost counts, lost steps, missed pulses, reference, shifted zero, collision, slip",
    formula="E = a after an unknown instant",
    units="a: µm or µrad; instant: s, or cycles done of a positioning test",
    typical="whole counts of the encoder, whole steps of a motor, 0.1 to 20 µm",
    source="counting errors of incremental encoders; motors without feedback",
    propose=propose,
    belongs_to="run",
)
