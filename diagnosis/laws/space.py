"""What a model leaves of a run, and how much of it columns of a law explain.

With ``M = 1 - Q Q^T`` over the rows of the data and the prior, a column c of unit noise explains
``(c^T M y)^2 / (c^T M c)`` of the squared residual: all that is needed of the model is Q and the
residual ``r = M y``. Columns of many laws share Q, so that thousands of them are one product of
matrices.
"""

from dataclasses import dataclass
from functools import cached_property

import numpy as np

from matstd.diagnosis.fit import Fit
from matstd.diagnosis.regression import PRIOR_DOF, BoolArray, solve
from matstd.twin.frames import Array
from matstd.twin.record import Touches

MIN_OWN = 1e-5
"""Least squared share of a column that the model cannot imitate: below it the rest is rounding."""

SMALLEST_SHARE = 1e-9
"""Least share of a direction of the data that the model imitates at all."""


@dataclass(frozen=True, eq=False)
class Space:
    """A fitted model, seen from its residual.

    Attributes:
        touches: All of the run.
        used: Rows that the fit rests upon, N of them.
        u: Their standard uncertainty as stated, (N,), mm.
        Q: Basis of the model, (N + P, P): rows of the data, then of the prior.
        residual: Residual over the stated uncertainty, (N + P,).
        dof: Degrees of freedom left.
    """

    touches: Touches
    used: BoolArray
    u: Array
    Q: Array
    residual: Array
    dof: float

    @classmethod
    def of(cls, fit: Fit) -> "Space":
        """What a fit leaves, in units of the stated uncertainty.

        The fit takes what it does not explain for noise, and its prior counts the more beside it:
        with a law in the model the noise is the stated one again, and so it is taken here.
        """
        factor = fit.noise.factor
        solution = solve(fit.X[fit.used] * factor, fit.y[fit.used] * factor)
        residual = np.concatenate([solution.residual, -solution.phi])
        return cls(
            touches=fit.run.touches,
            used=fit.used,
            u=fit.run.u[fit.used],
            Q=np.vstack([solution.Q, solution.root]),
            residual=residual,
            dof=max(solution.dof, 1.0),
        )

    @property
    def count(self) -> int:
        """Number of rows."""
        return len(self.u)

    @cached_property
    def basis(self) -> Array:
        """What the model can imitate of the data: A (N, K) with ``A A^T = Q_N Q_N^T``.

        Parameters that the prior decides reach the data not at all: of 155 columns of Q_N, the
        rows of the data in Q, 95 are left, exactly.
        """
        left, size, _ = np.linalg.svd(self.Q[: self.count], full_matrices=False)
        kept = size**2 > SMALLEST_SHARE
        return np.asarray(left[:, kept] * size[kept])

    @property
    def r(self) -> Array:
        """Rows of the data in the residual, (N,)."""
        return self.residual[: self.count]

    @property
    def square(self) -> float:
        """Squared residual, the prior's part and the stated noise included."""
        return float(self.residual @ self.residual) + PRIOR_DOF

    @property
    def freedom(self) -> float:
        """Observations behind `square`: those that the data have left.

        With N of them for ``y^T M y`` a sine of 0.1 mm was "learnt" from 130 touches of noise:
        set-ups have wide priors, and what they take up is no observation.
        """
        return self.dof + PRIOR_DOF

    def white(self, columns: Array) -> Array:
        """Columns (all rows, K), mm, over the uncertainty of the rows used, (N, K)."""
        return np.asarray(columns[self.used] / self.u[:, None])

    def own(self, C: Array) -> Array:
        """Columns (N, K) freed of what the model can imitate, (N + P, K)."""
        out = self.Q @ -(self.Q[: self.count].T @ C)
        out[: len(C)] += C
        return out

    def gained(self, explained: Array) -> Array:
        """Log evidence of explaining so much of the square, parameters not charged."""
        left = np.maximum(self.square - explained, 1e-9 * self.square)
        return np.asarray(-0.5 * self.freedom * np.log(left / self.square))

    def charge(self, parameters: float) -> float:
        """Log evidence that so many parameters cost: Schwarz's criterion."""
        return 0.5 * parameters * float(np.log(max(self.freedom, 2.0)))

    def explained(self, C: Array) -> float:
        """Squared residual that columns (N, K) explain together."""
        own = self.own(C)
        norm = np.linalg.norm(own, axis=0)
        kept = norm > np.sqrt(MIN_OWN) * np.linalg.norm(C, axis=0)
        if not kept.any():
            return 0.0
        W = own[:, kept] / norm[kept]
        values, vectors = np.linalg.eigh(W.T @ W)
        along = vectors.T @ (W.T @ self.residual)
        is_own = values > 1e-7
        return float((along[is_own] ** 2 / values[is_own]).sum())
