"""A saved law in operation: what it misses, learnt from probings, and how well it is known."""

from collections.abc import Iterable, Sequence

import numpy as np

from matstd.diagnosis.drift.drift_law import DriftLaw, Replay
from matstd.diagnosis.drift.probing import Unknowns
from matstd.twin.errors import DesignError
from matstd.twin.frames import Array
from matstd.twin.model import Effect
from matstd.twin.record import Touches


class LiveDrift:
    """The columns of a `DriftLaw` since a preset was taken, and what probings say of them.

    Every column has its own Kalman filter (`Unknowns`): coefficients that are wrong, and what
    passes. Both counted when the preset was taken, so that nothing is unknown there.
    """

    def __init__(self, law: DriftLaw, begin: Touches) -> None:
        """The law at the moment of the preset.

        Args:
            begin: The machine's history up to then, the moment last.
        """
        self.law = law
        self._begin = self._now = law.replay(begin)
        unit = np.eye(self._begin.rows.shape[1])
        memory = law.saved.law.memory
        self._unknowns = [Unknowns(float(law.spread[k] ** 2), unit, memory, True) for k in self._at]

    @classmethod
    def of(cls, effects: Iterable[Effect], begin: Touches) -> list["LiveDrift"]:
        """Those laws among the effects of a machine that have unknowns."""
        laws = [e for e in effects if isinstance(e, DriftLaw) and e.has_unknowns]
        return [cls(law, begin) for law in laws]

    @property
    def _at(self) -> tuple[int, ...]:
        return self.law.columns

    @property
    def columns(self) -> tuple[str, ...]:
        """Names of the outputs that are bound."""
        return tuple(self.law.saved.components[k] for k in self._at)

    @property
    def drift(self) -> Array:
        """Of every column since the preset, (C,), base units."""
        since = self._now.predicted[-1] - self._begin.predicted[-1]
        return np.array([since[k] for k in self._at]) + self._missed[0]

    @property
    def u(self) -> Array:
        """Standard uncertainty of it, (C,)."""
        return np.sqrt(self._missed[1])

    @property
    def u_begin(self) -> Array:
        """Standard uncertainty of the columns themselves when the preset was taken, (C,)."""
        known = np.sqrt(1.0 + (self._begin.rows[-1] ** 2).sum())
        return np.array([known * self.law.spread[k] for k in self._at])

    @property
    def missed(self) -> Array:
        """What probings add to the parameters of the law at this moment, (P,)."""
        theta = np.zeros(len(self.law.parameters))
        gone = 1.0 - np.exp(-2.0 * self._now.elapsed[-1] / self.law.saved.law.memory)
        if gone > 0.0:
            for k, missed in zip(self._at, self._missed[0], strict=True):
                theta[self.law.later(k)] = missed / (self.law.spread[k] * np.sqrt(gone))
        return theta

    def follow(self, history: Touches) -> None:
        """Go on to a later moment, the last one of a history."""
        now = self.law.replay(history)
        passed = float(now.elapsed[-1] - self._now.elapsed[-1])
        self._now = now
        for unknowns in self._unknowns:
            unknowns.advance(passed)

    def probed(self, left: Sequence[float], u: Sequence[float]) -> None:
        """Learn from a standard that was probed with the law's drift corrected.

        Args:
            left: What is left of every column, base units; NaN where nothing was probed.

        Raises:
            DesignError: Other numbers of values, or an uncertainty that is none.
        """
        for name, values in (("values", left), ("uncertainties", u)):
            if len(values) != len(self._at):
                expected = f"{len(self._at)}: {', '.join(self.columns)}"
                raise DesignError(f"{len(values)} probed {name}, expected {expected}")
        known = np.isfinite(left)
        if np.isinf(left).any() or not all(0.0 < v < np.inf for v in np.array(u)[known]):
            raise DesignError("probed values: expected numbers with uncertainties above zero")
        for unknowns, value, spread in zip(self._unknowns, left, u, strict=True):
            if np.isfinite(value):
                missed = unknowns.at(self._row)[0]
                unknowns.update(self._row, missed + value, spread**2)

    @property
    def _row(self) -> Array:
        return _last(self._now) - _last(self._begin)

    @property
    def _missed(self) -> tuple[Array, Array]:
        """What the law misses of every column since the preset, and its variance, (C,) each."""
        pairs = [unknowns.at(self._row) for unknowns in self._unknowns]
        missed, variance = np.array(pairs).reshape(-1, 2).T
        return missed, np.maximum(variance, 0.0)


def _last(replay: Replay) -> Array:
    return np.asarray(replay.rows[-1])
