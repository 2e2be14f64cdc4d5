"""Descriptions that explain a run equally: a probe of another length is a head with another pivot.

A number of the description that is wrong by d shows as ``c d`` with c its first-order column.
Of that, what ordinary errors of the machine and the set-ups take up at their usual sizes costs half
the square of their sizes over the usual ones, and what remains half its square over the noise.
Another number is a rival where it leaves so little of both that this run cannot distinguish them.
"""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass

import numpy as np

from matstd.diagnosis.fit import Fit
from matstd.diagnosis.geometry.quantities import is_geometry
from matstd.twin.effects import LocationError, ProbeRadius
from matstd.twin.library import ordinary_model
from matstd.twin.machine import Family
from matstd.twin.model import Effect, columns, traits
from matstd.twin.record import Touches
from matstd.twin.sampling import spread_rows

MAX_TOUCHES = 1000  # most touches that are used: more do not distinguish any further columns

MAX_LOG_ODDS_ALIKE = float(np.log(100.0))
"""Log odds below which two descriptions are not distinguished."""

MIN_COST_SHARE = 0.5
"""Share of the cost that a rival must at least take away; what takes less explains nothing."""

SETUP_FACTOR = 20.0
"""Factor on the usual freedom of the set-ups (1 mm, 5 mrad): they are no part of a machine. The
place of the standard is no mistake in the description and must not pass for the zero of a table or
the length of a tool."""


@dataclass(frozen=True, slots=True)
class FoundNumber:
    """A number of the description as the run has it, mm or rad."""

    name: str  # `radius`, `length`, or the location error that does the same, `EX0C`
    change: float  # what has to be added to what is stated
    u: float


class Descriptions:
    """The numbers of a description of a machine and a probe, and what a run says apart of them."""

    def __init__(self, fit: Fit) -> None:
        rows = np.flatnonzero(fit.used)
        rows = rows[spread_rows(len(rows), MAX_TOUCHES)]
        touches = fit.run.touches[rows]
        unit = fit.u[rows][:, None]
        # beside what was found: a number that imitates a found effect is no rival of a line
        found = [e for e in fit.model.effects if not is_geometry(e) and traits(e).original is None]
        machine = (*ordinary_model(touches.chain).effects, *found)
        sd = [p.sd for e in machine for p in e.parameters]
        sd += [SETUP_FACTOR * p.sd for e in fit.setups for p in e.parameters]
        A = columns((*machine, *fit.setups), touches) * sd / unit
        numbers = list(_numbers(touches))
        own = columns(numbers, touches) / unit
        Q = np.linalg.qr(np.vstack([A, np.eye(A.shape[1])]))[0]
        own = np.vstack([own, np.zeros((A.shape[1], own.shape[1]))])
        self.names = [_name(effect) for effect in numbers]
        self._left = own - Q @ (Q.T @ own)  # (N + P, K)

    def rivals(self, wrong: Sequence[tuple[str, float]]) -> tuple[FoundNumber, ...]:
        """Other numbers that explain some wrong ones equally, the nearest first.

        Args:
            wrong: Names of location errors with what each is wrong by, mm or rad.
        """
        known = [(self.names.index(name), d) for name, d in wrong if name in self.names]
        if not known:
            return ()
        y = sum((d * self._left[:, k] for k, d in known), start=np.zeros(len(self._left)))
        cost = 0.5 * float(y @ y)
        found = []
        for k, name in enumerate(self.names):
            c = self._left[:, k]
            strength = float(c @ c)
            if k in dict(known) or strength < 1e-12:
                continue
            change = float(c @ y) / strength
            left = cost - 0.5 * change**2 * strength
            if left < min(MAX_LOG_ODDS_ALIKE, MIN_COST_SHARE * cost):
                # the ball higher up is a shorter tool
                size = -change if name == "length" else change
                found.append((left, FoundNumber(name, size, strength**-0.5)))
        # equal to rounding, by name
        found.sort(key=lambda pair: (round(pair[0], 6), pair[1].name))
        return tuple(number for _, number in found)


def _numbers(touches: Touches) -> Iterator[Effect]:
    """Errors that do what wrong numbers of the description do."""
    if touches.radius.any():
        yield ProbeRadius()
    for symbol in touches.chain.symbols:
        is_of_axis = symbol.family is Family.LOCATION and touches.chain.link(symbol.link).programmed
        # a ball beside the tool axis; of reflectors the place is found, not stated
        is_of_ball = symbol.link == "t" and not symbol.is_angular and not touches.offset.any()
        if is_of_axis or is_of_ball:
            yield LocationError(symbol)


def _name(effect: Effect) -> str:
    own = traits(effect)
    name = own.symbol.name if own.symbol is not None else own.stated_number
    return "length" if name == "EZ0t" else name
