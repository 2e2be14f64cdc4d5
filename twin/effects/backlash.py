"""Reversal of an axis: the reading depends on the side from which it was reached."""

from collections.abc import Iterable, Sequence
from dataclasses import dataclass

import numpy as np

from twin.chain import Chain
from twin.effect import Parameter, Term, Where
from twin.effects.kind import Kind, counted, moving_axes, refusal
from twin.frames import Array
from twin.touches import Touches
from twin.units import UM, URAD

USAGE = "backlash(axis)"


@dataclass(frozen=True)
class Backlash:
    """Half the reversal of an axis, with the sign of its last motion.

    ``E = -(b/2) sgn(dq)`` along a linear axis, about a rotary one: an axis driven in the positive
    direction lags behind its reading. A touch whose last motion is unknown says nothing. One
    parameter, the reversal b, mm or rad: 0.5 to 2 um with direct scales, 3 to 15 um with motor
    encoders; rotary 5 to 100 urad.

    Attributes:
        axis: Name of the axis.
        component: Index of the component along or about the axis.

    Reference:
        ISO 230-2 (reversal value B).
    """

    axis: str
    component: int

    kind = "backlash"

    @property
    def name(self) -> str:
        """`backlash(X)`."""
        return f"backlash({self.axis})"

    @property
    def parameters(self) -> Sequence[Parameter]:
        """The reversal."""
        if self.component >= 3:
            return (Parameter("amplitude", "rad", 50 * URAD),)
        return (Parameter("amplitude", "mm", 10 * UM),)

    def terms(self, touches: Touches) -> Sequence[Term]:
        """A twist of the axis."""
        where = Where("twist", touches.chain.link_index(self.axis), self.component)
        return (Term(0, where, -0.5 * touches.last_move(self.axis)),)


def own_component(chain: Chain, axis: str) -> int:
    """Index of the component along a linear axis, about a rotary one; for a free direction the
    letter that it is nearest to decides.
    """  # noqa: D205
    link = chain.link(axis)
    main = int(np.argmax(np.abs(link.direction)))
    return main if link.kind == "linear" else 3 + main


def make(chain: Chain, arguments: Sequence[str]) -> Backlash:
    """From the axis."""
    counted(USAGE, arguments, 1, 1)
    axis = arguments[0]
    if axis not in chain.programmed_axes:
        raise refusal(USAGE, arguments, f"an axis of {', '.join(chain.programmed_axes)}")
    return Backlash(axis, own_component(chain, axis))


def propose(touches: Touches) -> Iterable[Backlash]:
    """Every axis that was reached from both sides."""
    for axis in moving_axes(touches):
        if _both_sides(touches.last_move(axis)):
            yield Backlash(axis, own_component(touches.chain, axis))


def _both_sides(last_move: Array) -> bool:
    return bool(np.any(last_move > 0) and np.any(last_move < 0))


KIND = Kind(
    word="backlash",
    arguments="axis",
    formula="E = -(b/2) sgn(last motion), along a linear axis or about a rotary one",
    units="b: µm; µrad of a rotary axis",
    typical="0.5 to 2 µm (direct scale), 3 to 15 µm (motor encoder); rotary 5 to 100 µrad",
    source="ISO 230-2",
    make=make,
    propose=propose,
)
