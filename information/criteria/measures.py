"""Remaining uncertainty of one machine after touches as one number: the criteria I, G, D, A, E.

With ``M = prior + F`` for the information ``F = W^T W`` of the touches,

    I, A   `MeanVariance`        trace(K M^-1), K the moments of a prediction, or the unit matrix
    G      `LargestVariance`     largest of trace(r_j^T M^-1 r_j), a root r_j for every pose
    E      `LargestEigenvalue`   largest eigenvalue of r^T M^-1 r
    D      `Determinant`         -log det M, shown as det(M)^(-1/R)

All are convex in F. The largest of several is smoothed in a search: a power mean stands for it.

Reference:
    Pukelsheim, Optimal Design of Experiments (1993), chapters 5 to 7; Kiefer, Annals of Statistics
    2 (1974) 849 (the family of power means); DuMouchel and Jones, Technometrics 36 (1994) 37
    (potential terms).
"""

from abc import ABC, abstractmethod
from dataclasses import dataclass, replace

import numpy as np

from matstd.information.criteria.tangents import LogDeterminant, Tangent, Trace
from matstd.twin.frames import Array

MIN_EIGENVALUE_RATIO = 1e-13
"""Share of the largest eigenvalue below which a direction is neither felt nor shown: rounding."""
_MIN_WEIGHT_RATIO = 1e-6  # share of the largest weight below which a form is left out of a tangent


class Measure(ABC):
    """Remaining uncertainty of one machine; smaller is better."""

    @property
    @abstractmethod
    def size(self) -> int:
        """R, directions and potential terms."""

    @property
    def sharpness(self) -> float:
        """Power of the mean that stands for the largest; infinite where nothing is smoothed."""
        return np.inf

    def sharper(self, factor: float) -> "Measure":
        """The same with a mean nearer to the largest, where it has one."""
        return self

    @abstractmethod
    def value(self, M: Array, smooth: bool = False) -> float:
        """At M, (R, R); smooth with a power mean for the largest."""

    @abstractmethod
    def tangent(self, M: Array, weight: float) -> Tangent:
        """Mean of forms that is nowhere above the measure, times the weight of the machine.

        Searches follow it and bounds rest on it.
        """

    @abstractmethod
    def extended(self, count: int, worth: float) -> "Measure":
        """With potential terms, together `worth` when nothing is known of them."""

    def shown(self, value: float) -> float:
        """A mean of values as it is stated."""
        return value


@dataclass(frozen=True, eq=False)
class MeanVariance(Measure):
    """``trace(K M^-1)``: the mean variance of a prediction (I), or of the parameters (A), mm^2."""

    K: Array  # moments of the prediction, (R, R), mm^2; the unit matrix for A

    @property
    def size(self) -> int:
        return len(self.K)

    def value(self, M: Array, smooth: bool = False) -> float:
        return float(np.trace(np.linalg.solve(M, self.K)))

    def tangent(self, M: Array, weight: float) -> Tangent:
        return Trace(weight * self.K)

    def extended(self, count: int, worth: float) -> "MeanVariance":
        return MeanVariance(_joined(self.K, count, worth))


@dataclass(frozen=True, eq=False)
class _Largest(Measure):
    """The largest of several variances, and the mean variance of what counts in any case."""

    roots: Array  # roots of the forms, (J, R, k)
    K: Array  # form that counts in any case, (R, R): that of potential terms
    sharpness: float = 16.0  # at first; searches raise it

    @property
    def size(self) -> int:
        return len(self.K)

    def sharper(self, factor: float) -> "_Largest":
        return replace(self, sharpness=factor * self.sharpness)

    @abstractmethod
    def each(self, M: Array) -> tuple[Array, Array]:
        """What the largest is taken of, (J,), and the roots that belong to it."""

    @abstractmethod
    def mixed(self, roots: Array, share: Array) -> Array:
        """Weighted mean of the forms, (R, R)."""

    def value(self, M: Array, smooth: bool = False) -> float:
        value = float(np.trace(np.linalg.solve(M, self.K))) if np.any(self.K) else 0.0
        each = self.each(M)[0]
        largest = max(float(each.max()), 1e-300)
        if not smooth:
            return value + largest
        mean = float(np.mean((np.maximum(each, 0.0) / largest) ** self.sharpness))
        return value + largest * mean ** (1.0 / self.sharpness)

    def tangent(self, M: Array, weight: float) -> Tangent:
        """Weighted mean of the forms, each the heavier the larger it is."""
        each, roots = self.each(M)
        share = (np.maximum(each, 0.0) / max(float(each.max()), 1e-300)) ** (self.sharpness - 1.0)
        return Trace(weight * (self.K + self.mixed(roots, share / share.sum())))

    def extended(self, count: int, worth: float) -> "_Largest":
        """The mean of the potential terms' variances counts beside the largest."""
        unfelt = np.zeros((len(self.roots), count, self.roots.shape[2]))
        roots = np.concatenate([self.roots, unfelt], axis=1)
        return replace(self, roots=roots, K=_joined(self.K, count, worth))


@dataclass(frozen=True, eq=False)
class LargestVariance(_Largest):
    """Largest variance of the tool point at any pose (worst-case I; G in the books), mm^2."""

    def each(self, M: Array) -> tuple[Array, Array]:
        J, R, k = self.roots.shape
        flat = np.moveaxis(self.roots, 1, 0).reshape(R, J * k)
        half = np.linalg.solve(np.linalg.cholesky(M), flat)
        return np.einsum("rn,rn->n", half, half).reshape(J, k).sum(axis=1), self.roots

    def mixed(self, roots: Array, share: Array) -> Array:
        # what is left out makes the sum less than one: no harm
        loud = share > _MIN_WEIGHT_RATIO * share.max()
        flat = np.moveaxis(roots[loud] * np.sqrt(share[loud])[:, None, None], 1, 0)
        flat = flat.reshape(self.size, -1)
        return np.asarray(flat @ flat.T)


@dataclass(frozen=True, eq=False)
class LargestEigenvalue(_Largest):
    """Largest eigenvalue of ``r^T M^-1 r`` (E), of the one root r, (1, R, k).

    With ``r r^T`` the moments of a prediction it is the variance, mean over the poses, of the least
    well determined error pattern; with r the unit matrix the E-criterion of the books.
    """

    @classmethod
    def of(cls, K: Array) -> "LargestEigenvalue":
        """For a root of a form K, (R, R)."""
        values, vectors = np.linalg.eigh(K)
        kept = values > MIN_EIGENVALUE_RATIO * values[-1]
        root = vectors[:, kept] * np.sqrt(values[kept])
        return cls(root[None], np.zeros_like(K))

    def each(self, M: Array) -> tuple[Array, Array]:
        """All eigenvalues, (k,), with the root along each eigenvector, (R, k)."""
        root = self.roots[0]
        values, vectors = np.linalg.eigh(root.T @ np.linalg.solve(M, root))
        return values, root @ vectors

    def mixed(self, roots: Array, share: Array) -> Array:
        return np.asarray((roots * share) @ roots.T)


@dataclass(frozen=True)
class Determinant(Measure):
    """``-log det M``: the volume of what stays unknown (Bayesian D), shown as ``det(M)^(-1/R)``."""

    R: int

    @property
    def size(self) -> int:
        return self.R

    def value(self, M: Array, smooth: bool = False) -> float:
        return float(-np.linalg.slogdet(M)[1])

    def tangent(self, M: Array, weight: float) -> Tangent:
        return LogDeterminant(weight)

    def extended(self, count: int, worth: float) -> "Determinant":
        """Potential terms join the determinant, whatever they are worth."""
        return Determinant(self.size + count)

    def shown(self, value: float) -> float:
        """``det(M)^(-1/R)``, the geometric mean over the machines."""
        return float(np.exp(value / self.size))


def _joined(K: Array, count: int, worth: float) -> Array:
    """A form with the mean variance of potential terms beside it."""
    R = len(K)
    out = np.zeros((R + count, R + count))
    out[:R, :R] = K
    if count:
        out[R:, R:] = worth / count * np.eye(count)
    return out
