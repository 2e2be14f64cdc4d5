"""What a model leaves of a run, and how much of it columns of a law explain.

With ``M = 1 - Q Q^T`` over the rows of the data and the prior, a column c of unit noise explains
``(c^T M y)^2 / (c^T M c)`` of the squared residual: all that is needed of the model is Q and the
residual ``r = M y``. Columns of many laws share Q, so that thousands of them are one product of
matrices.
"""

from dataclasses import dataclass

import numpy as np

from matstd.diagnosis.fit import Fit
from matstd.diagnosis.regression import PRIOR_DOF, solve
from matstd.twin.frames import Array, Mask
from matstd.twin.record import Touches

MIN_OWN = 1e-5
"""Least squared share of a column that the model cannot imitate: below it the rest is rounding."""

SMALLEST_OWN = 1e-7  # least square of a direction of columns of unit length that is no rounding

SMALLEST_COLUMN = 1e-100
"""Columns without larger numbers are those of a shape far from every touch; squares underflow."""

SMALLEST_SHARE = 1e-9  # least share of a direction of the data that the model imitates at all


@dataclass(frozen=True, eq=False)
class Space:
    """A fitted model, seen from its residual.

    Rows are all touches of the run; those that the fit does not use are zero, so that fits that use
    others share columns.
    """

    touches: Touches  # all of the run
    used: Mask  # rows that the fit rests upon, (N,)
    u: Array  # standard uncertainty of all as stated, (N,), mm
    basis: Array  # what the model can imitate of the data: A (N, K) with ``A A^T = Q Q^T``
    r: Array  # residual over the stated uncertainty, (N,)
    square: float  # squared residual, the prior's part and the stated noise included
    dof: float  # degrees of freedom left

    @classmethod
    def of(cls, fit: Fit) -> "Space":
        """What a fit leaves, in units of the stated uncertainty.

        The fit takes what it does not explain for noise, and its prior counts the more beside it:
        with a law in the model the noise is the stated one again, and so it is taken here.
        """
        factor = fit.noise.factor
        solution = solve(fit.X[fit.used] * factor, fit.y[fit.used] * factor)
        # parameters that the prior decides reach the data not at all: of 155 columns 95 are left
        left, size, _ = np.linalg.svd(solution.Q, full_matrices=False)
        kept = size**2 > SMALLEST_SHARE
        basis = np.zeros((len(fit.used), int(kept.sum())))
        basis[fit.used] = left[:, kept] * size[kept]
        r = np.zeros(len(fit.used))
        r[fit.used] = solution.residual
        both = np.concatenate([solution.residual, solution.phi])
        return cls(
            touches=fit.run.touches,
            used=fit.used,
            u=fit.run.u,
            basis=basis,
            r=r,
            square=float(both @ both) + PRIOR_DOF,
            dof=max(solution.dof, 1.0),
        )

    @property
    def count(self) -> int:
        """Number of rows."""
        return len(self.u)

    @property
    def freedom(self) -> float:
        """Observations behind `square`: those that the data have left.

        With N of them for ``y^T M y`` a sine of 0.1 mm was "learnt" from 130 touches of noise:
        set-ups have wide priors, and what they take up is no observation.
        """
        return self.dof + PRIOR_DOF

    def white(self, columns: Array) -> Array:
        """Columns (N, K), mm, over the uncertainty; zero where a row is not used."""
        return np.asarray(columns * (self.used / self.u)[:, None])

    def gained(self, explained: Array) -> Array:
        """Log evidence of explaining so much of the square, parameters not charged."""
        left = np.maximum(self.square - explained, 1e-9 * self.square)
        return np.asarray(-0.5 * self.freedom * np.log(left / self.square))

    def charge(self, parameters: float) -> float:
        """Log evidence that so many parameters cost: Schwarz's criterion."""
        return 0.5 * parameters * float(np.log(max(self.freedom, 2.0)))

    def explained(self, C: Array) -> float:
        """Squared residual that columns (N, K) explain together."""
        C = C * self.used[:, None]
        largest = np.abs(C).max(axis=0)
        C = C[:, largest > SMALLEST_COLUMN] / largest[largest > SMALLEST_COLUMN]
        U = self.basis.T @ C
        G, raw = C.T @ C, np.einsum("nk,nk->k", C, C)
        G -= U.T @ U
        kept = np.diagonal(G) > MIN_OWN * raw
        size = np.sqrt(np.diagonal(G)[kept])
        b = (self.r @ C)[kept] / size
        if len(b) < 2:
            return float(b @ b)
        values, vectors = np.linalg.eigh(G[np.ix_(kept, kept)] / np.outer(size, size))
        is_own = values > SMALLEST_OWN
        return float(((vectors.T @ b)[is_own] ** 2 / values[is_own]).sum())
