"""The test whether a smooth field of deviations is there that the model does not explain.

Measurements in units of independent noise are ``y = B b + f + z``, with B what is explained:
set-up, errors of the model, calibration, each in units of its prior. The field f is unknown but
smooth: its covariance is ``F F^T``. What is explained is averaged over,

    V = 1 + B B^T,   V^-1 = 1 - Q Q^T,   Q R = B,   R^T R = 1 + B^T B

and the ratio of the likelihoods with and without the field is a sum over the field's own patterns
``p_k``, the eigenvectors of ``V^-1/2 F F^T V^-1/2`` with the eigenvalues l:

    T = sum_k l_k / (1 + l_k) (p_k^T y)^2

A pattern that measurements show well counts in full, one that they hardly show counts nothing. A
chi-square over all N points instead has one degree of freedom a point: on a scan of thousands the
few that a smooth field moves drown in it.

Reference:
    M. L. King, Ann. Statist. 8 (1980) 1265 (point optimal tests);
    X. Lin, Biometrika 84 (1997) 309 (score test of a variance component).
"""

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from matstd.information.power.quadratic import exceedance, quantile
from matstd.twin.frames import Array, IntArray


def low_rank(
    diagonal: Array, column: Callable[[int], Array], left_out: float
) -> tuple[Array, IntArray]:
    """``F`` with ``F F^T = K`` but for a share of the trace: Cholesky with pivots.

    A smooth covariance of thousands of points has a rank of a few hundred; its columns are asked
    for only where they are used.

    Args:
        diagonal: Of K, (N,).
        column: Column of K at a point, (N,).
        left_out: Share of the trace of K that may be left out.

    Returns:
        Shape (N, M), and the points whose columns were used, (M,).

    Reference:
        Harbrecht, Peters, Schneider, Applied Numerical Mathematics 62 (2012) 428.
    """
    left = np.array(diagonal, dtype=np.float64)
    enough = left_out * left.sum()
    F, pivots = np.zeros((len(left), len(left))), list[int]()
    while left.sum() > enough:
        m, pivot = len(pivots), int(np.argmax(left))
        F[m] = (column(pivot) - F[:m, pivot] @ F[:m]) / np.sqrt(left[pivot])
        pivots.append(pivot)
        left = np.maximum(left - F[m] ** 2, 0.0)
        left[pivot] = 0.0
    return F[: len(pivots)].T, np.array(pivots, dtype=np.int64)


def decorrelated(columns: Array, u: Array, memory: Array) -> Array:
    """Columns in units of independent noise, (N, K).

    The noise of row i is ``e_i = m_i e_(i-1) u_i / u_(i-1) + sqrt(1 - m_i^2) u_i z_i``, z
    independent; what the row before already showed of it is subtracted.

    Args:
        columns: Deviations in mm, (N, K), in the order of the measurement.
        u: Standard uncertainty of every row, (N,), mm.
        memory: Correlation of the noise with that of the row before, (N,); 0 for a touch and at the
            start of a line.
    """
    scaled = columns / u[:, None]
    before = np.concatenate([np.zeros((1, scaled.shape[1])), scaled[:-1]])
    return np.asarray((scaled - memory[:, None] * before) / np.sqrt(1.0 - memory**2)[:, None])


_RANK = 1e-9  # eigenvalue relative to the largest, below which a pattern is rounding


@dataclass(frozen=True, eq=False)
class FieldTest:
    """A test for a smooth field, made for some measurements."""

    explained: Array  # ``Q``, (N, B)
    patterns: Array  # ``p``, what is multiplied with the measurements, (N, M)
    weight: Array  # ``l / (1 + l)`` of every pattern, (M,)
    risk: float  # probability that it finds a field where there is none
    threshold: float  # of T

    def statistic(self, y: Array) -> Array:
        """T of measurements (N, K) in units of independent noise, (K,)."""
        return np.asarray(self.weight @ (self.patterns.T @ y) ** 2)

    def signal(self, f: Array) -> Array:
        """Root of the noncentrality ``f^T V^-1 f`` of deviations (N, K), (K,).

        The number of standard deviations by which a test that knew f would see it.
        """
        seen = np.sum(f**2, axis=0) - np.sum((self.explained.T @ f) ** 2, axis=0)
        return np.sqrt(np.maximum(seen, 0.0))

    def power(self, f: Array) -> Array:
        """Probability that the test finds deviations (N, K), (K,)."""
        return exceedance(self.weight, (self.patterns.T @ f).T ** 2, self.threshold)

    def power_of_field(self, F: Array) -> float:
        """Probability that the test finds a random field with the covariance ``F F^T``."""
        half = np.sqrt(self.weight)[:, None]
        H = half * (self.patterns.T @ F)
        size = np.linalg.eigvalsh(np.diag(self.weight) + H @ H.T)
        size = size[size > _RANK * size[-1]]
        return float(exceedance(size, np.zeros((1, len(size))), self.threshold)[0])


def field_test(B: Array, F: Array, risk: float) -> FieldTest:
    """The test for a field with the covariance ``F F^T`` beside what is explained.

    Args:
        B: Columns of all that is explained, in units of prior and noise, (N, B).
        F: Factor of the covariance of the field in units of the noise, (N, M).
        risk: Probability of a false alarm.
    """
    Q = np.linalg.qr(np.concatenate([B, np.eye(B.shape[1])]))[0][: len(B)]
    seen = F - Q @ (Q.T @ F)  # V^-1 F
    value, vector = np.linalg.eigh(F.T @ seen)
    kept = value > _RANK * max(value[-1], 1e-300)
    value, vector = value[kept], vector[:, kept]
    weight = value / (1.0 + value)
    return FieldTest(
        explained=Q,
        patterns=seen @ (vector / np.sqrt(value)),
        weight=weight,
        risk=risk,
        threshold=quantile(weight, risk),
    )
