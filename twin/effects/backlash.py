"""Reversal of an axis: where it stands depends on the side from which it was reached."""

from collections.abc import Iterable, Sequence
from dataclasses import dataclass

import numpy as np

from twin.frames import Array
from twin.machine import Chain
from twin.model import (
    Kind,
    Parameter,
    Term,
    Title,
    Where,
    check_count,
    checked_axis,
    moving_axes,
)
from twin.record import Touches
from twin.units import UM, URAD


@dataclass(frozen=True)
class Backlash:
    """Reversal of an axis: it stands elsewhere when it comes from the other side.

    B is what was reached in the positive direction minus what was reached in the negative one;
    lost motion behind a motor encoder lags and is negative. A touch whose last motion is unknown
    is not disturbed.

    Attributes:
        axis: Name of the axis.
        component: Index of the component along or about the axis.
    """

    axis: str
    component: int

    kind = "backlash"

    @property
    def name(self) -> str:
        """`backlash(X)`."""
        return f"backlash({self.axis})"

    @property
    def title(self) -> Title:
        """In the words of those who run machines."""
        return Title(f"reversal of {self.axis}", self.axis)

    @property
    def parameters(self) -> Sequence[Parameter]:
        """The reversal."""
        if self.component >= 3:
            return (Parameter("amplitude", "rad", 50 * URAD),)
        return (Parameter("amplitude", "mm", 10 * UM),)

    def terms(self, touches: Touches) -> Sequence[Term]:
        """A twist of the axis."""
        where = Where("twist", touches.chain.link_index(self.axis), self.component)
        return (Term(0, where, 0.5 * touches.last_move(self.axis)),)


def make(chain: Chain, arguments: Sequence[str]) -> Backlash:
    """From the axis."""
    check_count(KIND.usage, arguments, 1, 1)
    axis = checked_axis(KIND.usage, arguments, arguments[0], chain)
    return Backlash(axis, chain.link(axis).own_component)


def propose(touches: Touches) -> Iterable[Backlash]:
    """Every axis that was reached from both sides."""
    for axis in moving_axes(touches):
        if _both_sides(touches.last_move(axis)):
            yield Backlash(axis, touches.chain.link(axis).own_component)


def _both_sides(last_move: Array) -> bool:
    return bool(np.any(last_move > 0) and np.any(last_move < 0))


KIND = Kind(
    word="backlash",
    arguments="axis",
    title="backlash / reversal",
    synonyms="reversal error, lost motion, play, hysteresis, dead band, reversal spike",
    formula="E = (B/2) sgn(last motion), along a linear axis or about a rotary one",
    units="B: µm; µrad of a rotary axis",
    typical="0.5 to 2 µm (direct scale), 3 to 15 µm (motor encoder); rotary 5 to 100 µrad",
    source="ISO 230-2 (forward minus backward)",
    make=make,
    propose=propose,
    classes=(Backlash,),
)
