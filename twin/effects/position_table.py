"""Position table of an axis: a smooth curve over its readings, or one for each direction.

A positioning test prints such a table, and a control compensates by it. It states the errors of an
axis without a cause: a pitch, a polynomial or a constant reversal explains them with fewer numbers
where it can.
"""

from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from typing import Annotated, Self

import numpy as np

from matstd.twin.effects.backlash import measured_component
from matstd.twin.fields import Argument, ComponentSymbol, Refuse, moving_axes
from matstd.twin.frames import Array
from matstd.twin.machine import Chain, Family, Symbol
from matstd.twin.model import Amounts, Declared, Effect, Kind, Parameter, Title, scanned
from matstd.twin.record import Touches
from matstd.twin.units import UM, URAD

ORDER = 20  # half waves over the travel: the resolution of 20 targets; faster ones are `periodic`
CORRELATION_LENGTHS = (0.04, 0.1, 0.3)
"""Tried correlation lengths, as shares of the travel: 0.04 is the distance of 25 targets; smoother
curves than 0.3 are polynomials of low degree."""
BY_DIRECTION = "directions"  # argument for separate curves of the two directions
MIN_TARGETS = 5  # fewest targets of a positioning test of one metre (ISO 230-2)
MIN_REVISITED_SHARE = 0.5
"""From this share of rows at readings approached before, readings are targets."""
WHOLE_TURN = 2.0 * np.pi - 0.02
"""From this travel of a rotary axis, rad, its curve is closed; a degree less leaves no gap."""


def _directions(text: str, chain: Chain, refuse: Refuse) -> bool:
    if text != BY_DIRECTION:
        raise refuse(f"nothing or '{BY_DIRECTION}' after the comma")
    return True


@dataclass(frozen=True)
class PositionTable(Declared):
    """A component error as a smooth curve over the reading, or one for each direction.

    ``E = sum_k a_k c_k(q)``, and with a curve for each direction besides ``sgn(last motion)/2
    (b_0 + sum_k b_k c_k(q))``; ``c_k = w_k cos(k pi s)`` with s the reading as a share of the
    travel, k to `ORDER`; sines and cosines of whole turns where a rotary axis turns all round. The
    finer a wave the less is expected of it: ``w_k ~ 1/(1 + (k pi l)^2)``, ``sum w_k^2 = 1``, l the
    correlation length. A constant belongs to the location of the axis.

    Reference:
        ISO 230-2 (mean deviation at every target for either direction, reversal at a target).
    """

    symbol: ComponentSymbol
    # whether each direction has its own curve; a reversal that is alike everywhere is `backlash`
    by_direction: Annotated[
        bool, Argument("directions", _directions, lambda by: BY_DIRECTION if by else "")
    ] = False
    is_round: bool = False  # whether the travel of a rotary axis closes in itself
    # l, as a share of the travel
    length: float = scanned("1", CORRELATION_LENGTHS, continuous=False)

    kind = "position-table"
    usual = (5 * UM, 20 * URAD)
    is_curve = True
    is_table = True
    harmonic = 0.0

    def on(self, chain: Chain, refuse: Refuse) -> Self:
        """Closed in itself where the axis turns all round."""
        link = chain.link(self.symbol.link)
        travel = link.range[1] - link.range[0]
        return replace(self, is_round=link.kind == "rotary" and travel > WHOLE_TURN)

    @cached_property
    def title(self) -> Title:
        by = "position and direction" if self.by_direction else "position"
        return Title(f"{self.symbol.title} by {by}", self.symbol.link)

    @property
    def _waves(self) -> tuple[tuple[str, int], ...]:
        """Function and number of half waves over the travel of every c_k."""
        if self.is_round:
            return tuple((f, 2 * k) for k in range(1, ORDER // 2 + 1) for f in ("sin", "cos"))
        return tuple(("cos", k) for k in range(1, ORDER + 1))

    @cached_property
    def parameters(self) -> Sequence[Parameter]:
        """The a_k of the mean curve; of two curves then the b_k of the reversal, b_0 first."""
        mean = [self.sized(f"{f}{k}") for f, k in self._waves]
        if not self.by_direction:
            return mean
        turned = [self.sized(f"reversal {p.name}", 0.5) for p in mean]
        return (*mean, self.sized("reversal"), *turned)

    def amounts(self, touches: Touches) -> Amounts:
        mean = self._curves(touches)
        half = 0.5 * touches.last_move(self.symbol.link)
        turned = [half, *(half * c for c in mean)] if self.by_direction else []
        return [*mean, *turned]

    @property
    def reversal(self) -> Callable[[Touches], Array] | None:
        """Forward less backward at some touches, per unit of every parameter."""
        return self._reversal if self.by_direction else None

    def _reversal(self, touches: Touches) -> Array:
        mean = self._curves(touches)
        still = [np.zeros(len(touches))] * len(mean)
        return np.stack([*still, np.ones(len(touches)), *mean], axis=1)

    def _curves(self, touches: Touches) -> list[Array]:
        """Every c_k at the readings of some touches, (N,) each."""
        low, high = touches.chain.link(self.symbol.link).range
        share = (touches.reading(self.symbol.link) - low) / (high - low)
        of = {"sin": np.sin, "cos": np.cos}
        k = np.array([k for _, k in self._waves])
        w = 1.0 / (1.0 + (np.pi * k * self.length) ** 2)
        w /= np.linalg.norm(w)
        waves = zip(w, self._waves, strict=True)
        return [float(wk) * of[f](k * np.pi * share) for wk, (f, k) in waves]


def propose(touches: Touches) -> Iterable[Effect]:
    """Positioning of an axis that moved alone, or that an instrument beside the machine saw at the
    same targets again and again; what leads aside or tilts where that was measured.

    Where a ball touches in many poses no axis stands often enough at one reading.
    """  # noqa: D205
    axes = moving_axes(touches)
    beside = not touches.instrument.is_ball_on_standard
    for axis in axes:
        if len(axes) == 1 or (beside and _has_targets(touches.reading(axis))):
            symbol = Symbol(measured_component(touches, axis), axis, Family.COMPONENT)
            yield KIND.make(touches.chain, (symbol.name,))
            if len(np.unique(touches.last_move(axis))) > 1:
                yield KIND.make(touches.chain, (symbol.name, BY_DIRECTION))


def _has_targets(q: Array) -> bool:
    """Whether readings are targets that were approached several times."""
    _, counts = np.unique(np.round(q, 4), return_counts=True)
    again = counts[counts > 1]
    return len(again) >= MIN_TARGETS and again.sum() >= MIN_REVISITED_SHARE * len(q)


KIND = Kind.of(
    PositionTable,
    title="position table of an axis",
    synonyms="positioning error, error table, compensation table, lead error compensation, "
    "ISO 230-2, mean deviation, reversal along the travel, screw error",
    formula="E = sum a_k c_k + sgn(last motion)/2 (b_0 + sum b_k c_k), c_k = w_k cos(k pi s), "
    "s = (q - q_min)/travel, k to 20",
    units="a_k, b_k: µm or µrad; length: share of the travel",
    typical="5 to 30 µm over a metre with an encoder on the motor, 1 to 5 µm with a scale",
    source="ISO 230-2 (mean unidirectional positioning deviations, reversal errors)",
    propose=propose,
)
