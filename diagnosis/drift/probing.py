"""A law of a drift that is kept right by probing: every probed standard corrects its state.

What the law leaves is a process that forgets itself (standard deviation and memory of the law's
own residual), and its coefficients are known only so well. Both are a Gaussian state, and a probed
drift is a reading of their sum: a Kalman filter. Between two probings the correction fades where
it was a passing residual and stays where it was a coefficient.

Reference: adaptive learning by on-machine probing, Blaser et al., J. Manuf. Syst. 44, 2017;
Kalman filter, Anderson and Moore, Optimal Filtering.
"""

from dataclasses import dataclass

import numpy as np

from matstd.diagnosis.drift.judged import Judged
from matstd.diagnosis.drift.linear import LinearLaw
from matstd.diagnosis.drift.record import DriftRecord
from matstd.twin.frames import Array, IntArray
from matstd.twin.units import DAY

RENEWAL_TIME = 2.0 * DAY
"""Time in which the coefficients of a machine change by their uncertainty, s. In a week with a
change of load half-way, 1 to 4 days change the residual by less than a tenth."""


@dataclass(frozen=True, eq=False)
class ProbedPrediction:
    """A drift as it is predicted with the probings up to every row."""

    predicted: Array  # (N, K), base units
    u: Array  # standard uncertainty, (N, K)
    offset_only: Array  # what holding the last probed value does, no law at all, (N, K)


def predict_with_probings(
    judged: Judged, record: DriftRecord, rows: IntArray, u: float | Array
) -> ProbedPrediction:
    """Predict with probings at some rows of a record.

    Args:
        record: Its displacement is known at `rows` only.
        u: Standard uncertainty of what was probed, µm or µrad, one for all or (n,).
    """
    law = judged.law
    free = law.predicted(record)
    basis = law.basis(record) if isinstance(law, LinearLaw) else np.zeros((len(record), 0))
    unit = law.covariance if isinstance(law, LinearLaw) else np.zeros((0, 0))
    known, noise = np.zeros(len(record), dtype=bool), np.zeros(len(record))
    known[rows], noise[rows] = True, u
    out, spread = np.empty_like(free), np.empty_like(free)
    for k in range(free.shape[1]):
        variance = float(judged.factor[k] * law.residual[k]) ** 2
        misses = record.displacement[:, k] - free[:, k]
        filtered = Unknowns(variance, unit, law.memory)
        for t in range(len(record)):
            if t:
                filtered.advance(record.step)
            if known[t]:
                filtered.update(basis[t], misses[t], (noise[t] * record.size[k]) ** 2)
            added, v = filtered.at(basis[t])
            out[t, k], spread[t, k] = free[t, k] + added, np.sqrt(v)
    return ProbedPrediction(out, spread, _held(record, known))


def _held(record: DriftRecord, known: np.ndarray) -> Array:
    """The last probed value, before the first one that value."""
    at = np.maximum.accumulate(np.where(known, np.arange(len(known)), -1))
    first = int(np.argmax(known))
    return record.displacement[np.where(at < 0, first, at)]


class Unknowns:
    """State of one component: what is wrong with every coefficient, then what passes.

    Args:
        variance: Of what passes.
        unit: Covariance of the coefficients per unit of it.
        memory: Of what passes, s.
        is_since: Whether the drift counts from now on: what passes at this moment is then a part
            of the zero, and stays in it.
    """

    def __init__(self, variance: float, unit: Array, memory: float, is_since: bool = False) -> None:
        m = len(unit)
        self.first = variance * unit
        self.variance, self.memory = variance, memory
        self._ends = np.array([1.0, -1.0] if is_since else [1.0])
        count = m + len(self._ends)
        self.mean = np.zeros(count)
        self.covariance = np.zeros((count, count))
        self.covariance[:m, :m] = self.first
        self.covariance[m:, m:] = variance

    def advance(self, step: float) -> None:
        """By some time, s."""
        m = len(self.first)
        fades = np.exp(-step / self.memory)
        self.mean[m] *= fades
        self.covariance[m] *= fades
        self.covariance[:, m] *= fades
        self.covariance[m, m] += self.variance * (1.0 - fades**2)
        self.covariance[:m, :m] += self.first * step / RENEWAL_TIME

    def update(self, row: Array, value: float, noise: float) -> None:
        """With a probed value of what the law misses, and its variance."""
        h = np.append(row, self._ends)
        across = self.covariance @ h
        gain = across / (h @ across + noise)
        self.mean += gain * (value - h @ self.mean)
        self.covariance -= np.outer(gain, across)

    def at(self, row: Array) -> tuple[float, float]:
        """What the law misses now, and its variance."""
        h = np.append(row, self._ends)
        return float(h @ self.mean), float(h @ self.covariance @ h)
