"""The part of a fit that is always refitted: geometry and set-ups, projected out of columns.

Columns stand over the stated uncertainty of the touches. The base is X (n, P), columns times the
root of their prior. With ``X = Q S V^T`` and noise of w stated uncertainties the matrix that frees
a column of all that the base can imitate is ``M(w) = 1 - Q D Q^T``, ``D = S^2 / (S^2 + w^2)``: one
decomposition serves every size of the noise.
"""

from dataclasses import dataclass
from functools import cached_property

import numpy as np

from matstd.diagnosis.fit import Fit
from matstd.diagnosis.regression import solve
from matstd.twin.frames import Array, Mask
from matstd.twin.model import Effect, columns


@dataclass(frozen=True, eq=False)
class Base:
    """Columns of geometry and set-ups of a fit, without the effects that can be switched."""

    fit: Fit  # the fit
    X: Array  # over the stated uncertainty, times the root of the prior, all rows, (N, P)
    y: Array  # deviations over the stated uncertainty less the prior's mean, all rows, (N,)
    is_setup: Mask  # which columns place the standard, (P,)

    @classmethod
    def of(cls, fit: Fit, switched: frozenset[str]) -> "Base":
        """The base of a fit; `switched` are the names of effects that are no part of it."""
        whole, setups = fit.noise.factor * fit.weight, {e.name for e in fit.setups}
        names = [e.name for e, _ in fit.parameters]
        kept = np.array([name not in switched for name in names], dtype=bool)
        is_setup = np.array([name in setups for name in names], dtype=bool)
        return cls(fit, fit.X[:, kept] * whole, fit.y * whole, is_setup[kept])

    @cached_property
    def _decomposed(self) -> tuple[Array, Array, Array]:
        """``Q`` (n, P), ``S`` (P,) and ``V`` (P, P) of the rows that the fit uses."""
        X = self.X[self.fit.used]
        missing = max(X.shape[1] - len(X), 0)  # of fewer touches than parameters, rows of zeros
        Q, R = np.linalg.qr(np.vstack([X, np.zeros((missing, X.shape[1]))]))
        Q = Q[: len(X)]
        U, S, Vt = np.linalg.svd(R)
        return Q @ U, S, Vt.T

    @property
    def Q(self) -> Array:
        """Orthonormal basis of the rows used, (n, P)."""
        return self._decomposed[0]

    def shrunk(self, whole: float) -> Array:
        """``D``: share of every direction of `Q` that the fit takes, (P,)."""
        squares = self._decomposed[1] ** 2
        return squares / (squares + whole**2)

    def freed(self, C: Array, whole: float) -> Array:
        """``M C``: columns of the rows used freed of the base, (n, K)."""
        return C - self.Q @ (self.shrunk(whole)[:, None] * (self.Q.T @ C))

    def imitating(self, C: Array, whole: float) -> Array:
        """Coefficients of the base that imitate columns of the rows used best, (P, K)."""
        _, S, V = self._decomposed
        return V @ ((S / (S**2 + whole**2))[:, None] * (self.Q.T @ C))

    def columns(self, effects: list[Effect]) -> Array:
        """Columns of effects over the stated uncertainty, as the fit sees them, all rows."""
        out = columns(effects, self.fit.run.touches) / self.fit.run.u[:, None]
        filter_, used = self.fit.whitener, self.fit.used
        if filter_ is not None:
            out[used] = filter_.filtered(out[used])
        return out

    def coloured(self, C: Array) -> Array:
        """Whitened columns of the rows used as they are in the touches, (n, K)."""
        filter_ = self.fit.whitener
        if filter_ is None:
            return C
        return np.stack([filter_.coloured(column) for column in C.T], axis=1).reshape(C.shape)

    def residuals(self, C: Array, whole: float) -> Array:
        """What a column of all rows (N, K) leaves of itself in the residuals, mm, (N, K)."""
        fit, used = self.fit, self.fit.used
        out = C - self.X @ self.imitating(C[used], whole)
        out[used] = self.coloured(out[used])
        first = len(fit.parameters) - len(fit.tangents) - sum(len(s.parameters) for s in fit.setups)
        place = np.flatnonzero(self.is_setup)
        for rows, part in fit.unseen_setups:
            S = self.X[np.ix_(rows, place[part.start - first : part.stop - first])]
            out[rows] -= S @ np.linalg.lstsq(S, out[rows], rcond=None)[0]
        return out * fit.run.u[:, None]

    @cached_property
    def _machine(self) -> tuple[Array, Array]:
        """Coloured columns of the rows used: of the machine (n, P') and of the set-ups."""
        X = self.coloured(self.X[self.fit.used])
        return X[:, ~self.is_setup], X[:, self.is_setup]

    @cached_property
    def _squared(self) -> Array:
        """``X^T u^2 X / n`` of the machine's columns, mm^2."""
        X = self._machine[0]
        u = self.fit.run.u[self.fit.used]
        return np.asarray(X.T @ (X * u[:, None] ** 2) / len(u))

    def placed(self, whole: float) -> Array:
        """Orthonormal columns of what the set-ups take up, (n, P'')."""
        setups = self._machine[1] / whole
        return solve(setups, np.zeros(len(setups))).Q

    def new_run(self, whole: float) -> float:
        """Mean square of ``u^2 (1 + l - p)`` at the touches with the base alone, mm^2.

        The factor of `Fit.test_rms` on the error of poses left out, without effects: l is the
        variance of the machine's prediction that no set-up takes up, p what its set-up takes.
        """
        X, u = self._machine[0], self.fit.run.u[self.fit.used]
        placed = self.placed(whole)
        _, S, V = self._decomposed
        root = V[~self.is_setup] / np.sqrt(S**2 + whole**2)
        Z, weighed = placed.T @ X, placed * u[:, None] ** 2
        cross = Z.T @ (weighed.T @ X) / len(u)
        N = self._squared - cross - cross.T + Z.T @ (placed.T @ weighed / len(u)) @ Z
        spread = float(np.einsum("pk,pq,qk->", root, N, root))
        taken = float(np.mean(u**2 * (1.0 - (placed**2).sum(axis=1))))
        return taken + self.fit.weight**2 * spread

    def new_run_square(self, A: Array, whole: float) -> Array:
        """``H3``: what further columns (n, K) add to it, per unit of their covariance, (K, K)."""
        machine = self.imitating(A, whole)[~self.is_setup]
        D = self.coloured(A) - self._machine[0] @ machine
        placed = self.placed(whole)
        D = (D - placed @ (placed.T @ D)) * self.fit.run.u[self.fit.used, None]
        return np.asarray(D.T @ D / len(D))
