"""Reversal of an axis: its position depends on the direction of approach."""

from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from matstd.twin.fields import check_count, component_symbol, moving_axes, read_axis, refusal
from matstd.twin.machine import LETTERS, Chain, Family, Symbol
from matstd.twin.model import Amounts, Declared, Kind, Title, Where
from matstd.twin.record import Touches
from matstd.twin.units import UM, URAD

MIN_FELT_SHARE = 1e-6  # a component below this share of the largest one is not measured at all


@dataclass(frozen=True)
class Backlash(Declared):
    """Reversal of an axis: it stands elsewhere when it comes from the other side.

    B is what was reached in the positive direction minus what was reached in the negative one;
    lost motion behind a motor encoder lags and is negative. A touch whose last motion is unknown
    is not disturbed.
    """

    axis: str
    component: int  # index of the component that reverses: along or about the axis, as a rule

    kind = "backlash"
    usual = (10 * UM, 50 * URAD)

    @cached_property
    def name(self) -> str:
        """`backlash(X)`; `backlash(EBX)` of another error than its own."""
        return f"backlash({self.axis if self._is_own else self._symbol.name})"

    @cached_property
    def title(self) -> Title:
        what = self.axis if self._is_own else f"the {self._symbol.title}"
        return Title(f"reversal of {what}", self.axis)

    @property
    def _is_own(self) -> bool:
        return LETTERS[self.component] == self.axis[0]

    @property
    def _symbol(self) -> Symbol:
        return Symbol(self.component, self.axis, Family.COMPONENT)

    @property
    def is_angular(self) -> bool:
        return self._symbol.is_angular

    def where(self, chain: Chain) -> Where:
        return chain.twist_of(self._symbol)

    def amounts(self, touches: Touches) -> Amounts:
        return (0.5 * touches.last_move(self.axis),)


def make(chain: Chain, arguments: Sequence[str]) -> Backlash:
    """From the axis, or the component error."""
    check_count(KIND.usage, arguments, 1, 1)
    if len(arguments[0]) > 2 and arguments[0].startswith("E"):
        symbol = component_symbol(chain, arguments[0])
        return Backlash(symbol.link, symbol.component)
    axis = read_axis(arguments[0], chain, lambda text: refusal(KIND.usage, arguments, text))
    return Backlash(axis, chain.link(axis).own_component)


def propose(touches: Touches) -> Iterable[Backlash]:
    """The measured component of every axis that was reached from both sides."""
    for axis in moving_axes(touches):
        move = touches.last_move(axis)
        if np.any(move > 0) and np.any(move < 0):
            yield Backlash(axis, measured_component(touches, axis))


def measured_component(touches: Touches, axis: str) -> int:
    """Component of an axis that an instrument beside it sees: its own, unless that is not felt.

    Of a straightness it is the one across, of an angle of a linear axis that about which it tilts.
    """
    chain = touches.chain
    own = chain.link(axis).own_component
    felt = [
        float(np.abs(touches.signature.of(chain.twist_of(Symbol(c, axis, Family.COMPONENT)))).sum())
        for c in range(6)
    ]
    if felt[own] > MIN_FELT_SHARE * max(felt):
        return own
    kind = slice(3, 6) if touches.instrument.reads_angle else slice(0, 3)
    return (kind.start or 0) + int(np.argmax(felt[kind]))


KIND = Kind(
    word="backlash",
    arguments="axis or symbol",
    title="backlash / reversal",
    synonyms="reversal error, lost motion, play, hysteresis, dead band, reversal spike",
    formula="E = (B/2) sgn(last motion), along a linear axis or about a rotary one, "
    "or of a straightness or tilt that was measured (EBX)",
    units="B: µm; µrad of a rotary axis",
    typical="0.5 to 2 µm (direct scale), 3 to 15 µm (motor encoder); rotary 5 to 100 µrad",
    source="ISO 230-2 (forward minus backward)",
    make=make,
    propose=propose,
    classes=(Backlash,),
)
