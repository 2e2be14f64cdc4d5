"""Bayesian linear least squares in whitened arrays: one QR, and what follows from it.

The observations are ``y = X phi + noise`` with unit noise and a unit normal prior on ``phi``: both
are scaled before they come here. The prior is as many rows more, so that weakly determined
directions are kept by it and nothing is ever singular. With ``[X; 1] = [Q; Q'] R`` the matrix
``1 - Q Q^T`` is the inverse of the covariance ``1 + X X^T`` that y has before anything is fitted;
leverages, left-out predictions and tests of further columns all rest on it.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np
from scipy.linalg import cho_solve, solve_triangular
from scipy.linalg.lapack import dtpmqrt, dtpqrt

from matstd.twin.frames import Array, IntArray

REFLECTED = 16
"""Columns of a QR whose reflections are made together; with 32 it takes a few percent longer."""


@dataclass(frozen=True, eq=False)
class Solution:
    """Estimates of scaled parameters, and the projection on what they cannot imitate."""

    Q: Array  # upper rows of the orthonormal basis of the columns with their prior, (N, P)
    R: Array  # its triangle, (P, P): covariance ``R^-1 R^-T``
    phi: Array  # estimates, (P,), in units of their prior standard deviations
    residual: Array  # ``y - X phi``, (N,)

    @cached_property
    def leverage(self) -> Array:
        """Share of every row that the fit takes from itself, ``diag(Q Q^T)``, (N,)."""
        return np.einsum("np,np->n", self.Q, self.Q)

    @property
    def effective_parameters(self) -> float:
        """Number of parameters that the data, rather than the prior, decide."""
        return float(self.leverage.sum())

    @property
    def dof(self) -> float:
        """Degrees of freedom left for the noise."""
        return len(self.residual) - self.effective_parameters

    @property
    def objective(self) -> float:
        """``y^T (1 + X X^T)^-1 y``: squared residual plus squared distance from the prior."""
        return float(self.residual @ self.residual + self.phi @ self.phi)

    @cached_property
    def root(self) -> Array:
        """``R^-1``, (P, P): covariance of the scaled parameters is ``root root^T``."""
        identity = np.eye(len(self.R))
        return np.asarray(solve_triangular(self.R, identity, check_finite=False))

    @property
    def covariance(self) -> Array:
        """Posterior covariance of the scaled parameters, (P, P)."""
        return self.root @ self.root.T

    def spread(self, X: Array) -> Array:
        """Root of the covariance of predictions ``X phi``: (M, P), its squared row sums are the
        variances.
        """  # noqa: D205
        return X @ self.root


def solve(X: Array, y: Array) -> Solution:
    """Fit scaled parameters with a unit normal prior to observations of unit noise.

    Args:
        X: Columns times prior standard deviation over noise, (N, P).
        y: Observations over noise, (N,).
    """
    if not X.size:
        return Solution(X, np.eye(X.shape[1]), np.zeros(X.shape[1]), y)
    # below the triangle that the prior is already: two thirds of the time of a QR of both
    prior = np.eye(X.shape[1], order="F")
    R, V, T = below(prior, X)
    _, Q, _ = dtpmqrt(0, V, T, prior, np.zeros_like(X, order="F"), overwrite_b=True)
    phi = solve_triangular(R, Q.T @ y, check_finite=False)
    return Solution(np.ascontiguousarray(Q), R, phi, y - X @ phi)


def below(R: Array, X: Array, is_triangle: bool = False) -> tuple[Array, Array, Array]:
    """QR of rows X, an upper triangle or not, below an upper triangle R, whose zeros count as such.

    Returns its triangle, reflections and their factors, as LAPACK's `tpqrt` does.
    """
    triangle, V, T, _ = dtpqrt(len(X) if is_triangle else 0, min(REFLECTED, len(R)), R, X)
    return triangle, V, T


@dataclass(frozen=True, eq=False)
class LeftOut:
    """Prediction of groups of touches by a fit to all the others."""

    error: Array  # observed minus predicted, whitened, (N,); its own noise is 1
    squared: float  # sum over groups of ``error^T cov^-1 error``, cov that of the prediction error
    log_det: float  # sum over groups of ``log det cov``

    @property
    def rms(self) -> float:
        """Root mean square error, freed of the prediction's own uncertainty: 1 for a right model.

        ``sqrt(squared / N)``, which weights the errors of a group by their covariance and so has
        the smallest scatter that N errors can have, ``1/sqrt(2 N)``.
        """
        return float(np.sqrt(self.squared / max(len(self.error), 1)))


def left_out(Q: Array, residual: Array, groups: Sequence[IntArray]) -> LeftOut:
    """Leave one group out at a time, in closed form.

    With ``M = 1 - Q Q^T`` over the rows of a group, the prediction error of the group by a fit to
    the other rows is ``M^-1 r`` and has covariance ``M^-1``.

    Args:
        Q: Basis of the model over all rows, prior rows aside, (N, P).
        residual: Residuals of the fit to all rows, (N,).
        groups: Row numbers of every group; together all rows.
    """
    error = np.zeros(len(residual))
    squared, log_det = 0.0, 0.0
    for rows in groups:
        part, here = Q[rows], residual[rows]
        if len(rows) <= Q.shape[1]:
            L = np.linalg.cholesky(np.eye(len(rows)) - part @ part.T)
            error[rows] = cho_solve((L, True), here, check_finite=False)
        else:  # the same by the matrix of the other rows, which is the smaller one
            L = np.linalg.cholesky(np.eye(Q.shape[1]) - part.T @ part)
            error[rows] = here + part @ cho_solve((L, True), part.T @ here, check_finite=False)
        squared += float(here @ error[rows])
        log_det -= 2.0 * float(np.log(np.diag(L)).sum())
    return LeftOut(error, squared, log_det)
