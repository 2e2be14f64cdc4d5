"""Saved laws of a thermal drift among the errors of a machine, kept right while it works."""

from collections.abc import Sequence

import numpy as np

from matstd.compensation.field import Datum, MachineErrors
from matstd.compensation.service.history import History
from matstd.diagnosis.drift import DriftLaw, LiveDrift
from matstd.twin.errors import DesignError
from matstd.twin.frames import Array
from matstd.twin.record import Touches


class Drifts:
    """The laws of one machine since its preset was taken.

    Attributes:
        others: Rows of all other parameters in the root of the covariance, (P',).
    """

    def __init__(self, errors: MachineErrors, datum: Datum) -> None:
        """The laws where the preset is taken."""
        self._errors = errors
        self._at_datum = errors.touches(datum.q[None, :], datum.length)
        laws = [e for e in errors.effects if isinstance(e, DriftLaw) and e.has_unknowns]
        self._laws = [LiveDrift(law, self._at_datum) for law in laws]
        is_law = [effect in laws for effect in errors.effects]
        counts = [len(theta) for theta in errors.theta]
        self.others = np.flatnonzero(~np.repeat(np.array(is_law, dtype=bool), counts))

    @property
    def columns(self) -> tuple[str, ...]:
        """Outputs that are bound, of all laws."""
        return tuple(name for live in self._laws for name in live.columns)

    @property
    def drift(self) -> list[float]:
        """Drift of every column since the preset, mm or rad."""
        return [float(v) for live in self._laws for v in live.drift]

    @property
    def u(self) -> list[float]:
        """Standard uncertainty of each."""
        return [float(v) for live in self._laws for v in live.u]

    @property
    def learnt(self) -> dict[str, Array]:
        """Parameters of the laws with what was probed, by the names of their effects."""
        pairs = zip(self._errors.effects, self._errors.theta, strict=True)
        known = {effect.name: theta for effect, theta in pairs}
        return {live.law.name: known[live.law.name] + live.missed for live in self._laws}

    def follow(self, history: History) -> None:
        """Go on to the present moment of a history."""
        if self._laws:
            touches = history.touches(self._errors.chain, self._at_datum.q, self._at_datum.length)
            for live in self._laws:
                live.follow(touches)

    def probed(self, left: Sequence[float], u: Sequence[float]) -> None:
        """What is left of every column with the corrections on; raises DesignError."""
        columns = self.columns
        if not columns:
            raise DesignError("probed values: expected a saved law, drift-law(...), in the model")
        if len(left) != len(columns) or len(u) != len(columns):
            found = f"{len(left)} values and {len(u)} uncertainties"
            raise DesignError(f"{found} probed, expected {len(columns)}: {', '.join(columns)}")
        start = 0
        for live in self._laws:
            end = start + len(live.columns)
            live.probed(left[start:end], u[start:end])
            start = end

    def at(self, touches: Touches) -> Array:
        """What a standard deviation of every column does to the tool point of one pose, (3, C).

        The columns since the preset, and, where a column is not the same everywhere, those of the
        moment of the preset too.
        """
        out = [np.zeros((3, 0))]
        for live in self._laws:
            now, then = _moved(live, touches), _moved(live, self._at_datum)
            out += [now * live.u, (now - then) * live.u_begin]
        return np.hstack(out)


def _moved(live: LiveDrift, touches: Touches) -> Array:
    """Tool point of the first touch per unit of every column, (3, C)."""
    out = np.zeros((3, len(live.columns)))
    for bound in live.law.bound:
        reach = touches.reach.of(touches.chain.twist_of(bound.symbol))[0]
        out[:, live.columns.index(bound.column)] += bound.share(touches)[0] * reach
    return out
