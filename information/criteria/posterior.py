"""Posterior of a model's parameters for planned measurements.

Everything here is linear: a row is the deviation along the normal of one touch per unit of every
parameter (``n^T J`` times the shape functions, `matstd.twin.model.model.columns`), with a prior
standard deviation for every parameter and a standard uncertainty for every touch. Rows are
*whitened*, ``W = rows * prior_sd / u``, so that one is what a typical error shows against the
noise.
"""

from dataclasses import dataclass
from functools import cached_property

import numpy as np

from matstd.twin.errors import ShapeMismatch
from matstd.twin.frames import Array


def whitened(rows: Array, prior_sd: Array, u: Array | float) -> Array:
    """Rows in units of noise for parameters in units of their prior, ``W``, (N, P).

    Args:
        rows: Deviation along the normal per unit of every parameter, (N, P).
        prior_sd: Expected standard deviation of every parameter, (P,).
        u: Standard uncertainty of each touch, scalar or (N,), mm.
    """
    if rows.ndim != 2 or rows.shape[1] != len(prior_sd):
        raise ShapeMismatch(f"rows of shape {rows.shape}, expected (N, {len(prior_sd)})")
    scale = np.broadcast_to(np.asarray(u, dtype=float), (len(rows),))
    return np.asarray(rows * prior_sd / scale[:, None])


@dataclass(frozen=True, eq=False)
class Posterior:
    """Posterior of the parameters after planned touches; normal, linear."""

    W: Array  # whitened rows, shape (N, P)
    prior_sd: Array  # expected standard deviation of every parameter, (P,)
    names: tuple[str, ...]

    @cached_property
    def information(self) -> Array:
        """``1 + W^T W``, (P, P), for parameters in units of their prior."""
        return np.eye(len(self.prior_sd)) + self.W.T @ self.W

    @cached_property
    def _factor(self) -> Array:
        return np.asarray(np.linalg.cholesky(self.information), dtype=np.float64)

    @cached_property
    def covariance(self) -> Array:
        """Of the parameters after the touches, (P, P), base units."""
        half = np.linalg.solve(self._factor, np.diag(self.prior_sd))
        return half.T @ half

    @cached_property
    def sd(self) -> Array:
        """Standard deviation of every parameter after the touches, (P,), base units."""
        return np.asarray(np.sqrt(np.diag(self.covariance)))

    @cached_property
    def spectrum(self) -> tuple[Array, Array]:
        """Singular values of W, largest first, (P,), and their directions as columns, (P, P).

        A direction with singular value s is known with 1/(1 + s^2) of its prior variance.
        """
        values, vectors = np.linalg.eigh(self.W.T @ self.W)
        return np.sqrt(np.maximum(values[::-1], 0.0)), vectors[:, ::-1]

    @cached_property
    def degrees_of_freedom(self) -> float:
        """Number of combinations that the touches determine: trace of 1 - posterior/prior."""
        s2 = self.spectrum[0] ** 2
        return float(np.sum(s2 / (1.0 + s2)))

    @cached_property
    def alone(self) -> tuple[str, ...]:
        """Parameters determined individually: variance reduced at least tenfold."""
        known = self.sd**2 < 0.1 * self.prior_sd**2
        return tuple(name for name, k in zip(self.names, known, strict=True) if k)

    def predicted_sd(self, G: Array) -> Array:
        """Root mean square of what stays unknown of the tool point at M poses, (M,), mm.

        ``sqrt(trace(G Sigma G^T))`` for the deviation G of the tip per unit of every parameter,
        (M, 3, P).
        """
        scaled = np.moveaxis(G * self.prior_sd, 2, 0).reshape(len(self.prior_sd), -1)
        half = np.linalg.solve(self._factor, scaled).reshape(len(self.prior_sd), len(G), 3)
        return np.sqrt(np.einsum("pmi,pmi->m", half, half))


def prior_sd_of_tip(G: Array, prior_sd: Array) -> Array:
    """Root mean square of the tool point's deviation before any measurement, (M,), mm."""
    return np.asarray(np.linalg.norm(G * prior_sd, axis=(1, 2)))
