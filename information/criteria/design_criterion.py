"""What touches are chosen for: criteria of what stays unknown after them, all of one family.

With ``M_s = prior_s + F`` for the information ``F = W^T W`` of the touches and the prior of a drawn
machine s, a machine's value is

    trace(K M_s^-1) + largest of trace(r_j^T M_s^-1 r_j)   (I, A; with roots r_j: worst pose, G)
    trace(K M_s^-1) + largest eigenvalue of r^T M_s^-1 r   (E)
    det(M_s)^(-1/R)                                        (D)

and the criterion its mean over the machines, or over the worst of them (conditional value at risk).
Without drawn machines the prior is the unit matrix. All are convex in F. The largest of several
forms is the largest weighted mean of them, so at any F there is a `Tangent`, a weighted mean that
is nowhere above the criterion; searches follow it and bounds rest on it.

Reference:
    Pukelsheim, Optimal Design of Experiments (1993), chapters 5 to 7; Kiefer, Annals of Statistics
    2 (1974) 849 (the family of power means); Rockafellar and Uryasev, J. Risk 2 (2000) 21.
"""

from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np

from twin.errors import DesignError
from twin.frames import Array

_SHOWN = 1e-13  # share of the largest: below it a direction is neither felt nor shown


@dataclass(frozen=True, eq=False)
class Tangent:
    """A criterion seen from one information: ``sum_s trace(K_s M_s^-1)``, nowhere above it.

    For D the machines' weights in the mean logarithm of the determinants.

    Attributes:
        K: Forms with their weights in them, (S, R, R).
        weight: Of the machines, (S,), sum one.
    """

    K: Array
    weight: Array


@dataclass(frozen=True, eq=False)
class DesignCriterion:
    """A criterion over the directions of parameter space that matter; smaller is better.

    Attributes:
        directions: Orthonormal columns, (P, R'): everything that a tool point or a touch can feel.
        K: Form that counts in any case, (R, R), mm^2. R is R' and the number of potential terms.
        is_determinant: Whether the volume of what stays unknown counts (D) instead.
        roots: Roots of the forms of which the largest counts, (J, R, k); None where none does.
        is_spectral: Whether of the one root the largest eigenvalue counts (E), not the trace.
        priors: Inverse covariances of drawn machines, (S, R, R); None for the unit matrix.
        tail: Share of the machines, the worst, over which is averaged; 1 for all.
        sharpness: Power of the mean that stands for the largest of several in a search.
    """

    directions: Array
    K: Array
    is_determinant: bool = False
    roots: Array | None = None
    is_spectral: bool = False
    priors: Array | None = None
    tail: float = 1.0
    sharpness: float = 16.0

    def __post_init__(self) -> None:
        if not 0.0 < self.tail <= 1.0:
            raise DesignError(f"tail {self.tail:g} of the machines, expected above 0 and up to 1")

    @cached_property
    def prior(self) -> Array:
        """Inverse prior covariance of every machine, (S, R, R)."""
        return np.eye(len(self.K))[None] if self.priors is None else self.priors

    @property
    def is_curved(self) -> bool:
        """Whether the tangent turns as touches come and go."""
        return self.roots is not None or (self.tail < 1.0 and len(self.prior) > 1)

    def rows(self, W: Array) -> Array:
        """Whitened rows (N, P) in the directions that matter, (N, R')."""
        reduced: Array = W @ self.directions
        return reduced

    def value(self, information: Array) -> float:
        """Criterion for W^T W (R, R) of some rows.

        Predicted variance, mm^2, or for D ``det(M)^(-1/R)``.
        """
        values = np.array([self._machine(M) for M in self.prior + information])
        if self.is_determinant:
            return float(np.exp(_worst_weights(values, self.tail) @ values / len(self.K)))
        return float(_worst_weights(values, self.tail) @ values)

    def merit(self, information: Array) -> float:
        """As `value`, with a power mean for the largest: what a search may go down by."""
        values = np.array([self._machine(M, smooth=True) for M in self.prior + information])
        if self.is_determinant:
            return float(np.exp(_worst_weights(values, self.tail) @ values / len(self.K)))
        return float(_worst_weights(values, self.tail) @ values)

    def _machine(self, M: Array, smooth: bool = False) -> float:
        """Value of one machine; for D the negative logarithm of its determinant."""
        if self.is_determinant:
            return float(-np.linalg.slogdet(M)[1])
        value = float(np.trace(np.linalg.solve(M, self.K))) if np.any(self.K) else 0.0
        if self.roots is None:
            return value
        each = self._each(M)[0]
        largest = max(float(each.max()), 1e-300)
        if not smooth:
            return value + largest
        mean = float(np.mean((np.maximum(each, 0.0) / largest) ** self.sharpness))
        return value + largest * mean ** (1.0 / self.sharpness)

    def _each(self, M: Array) -> tuple[Array, Array]:
        """What the largest is taken of, (J,), and for E the directions of the eigenvalues."""
        assert self.roots is not None
        J, R, k = self.roots.shape
        if self.is_spectral:
            root = self.roots[0]
            values, vectors = np.linalg.eigh(root.T @ np.linalg.solve(M, root))
            return values, root @ vectors
        flat = np.moveaxis(self.roots, 1, 0).reshape(R, J * k)
        half = np.linalg.solve(np.linalg.cholesky(M), flat)
        return np.einsum("rn,rn->n", half, half).reshape(J, k).sum(axis=1), np.zeros(0)

    def tangent(self, information: Array) -> Tangent:
        """The criterion as seen from some information (R, R)."""
        M = self.prior + information
        values = np.array([self._machine(m) for m in M]) if self.tail < 1.0 else np.zeros(len(M))
        weight = _worst_weights(values, self.tail)
        if self.is_determinant or self.roots is None:
            return Tangent(weight[:, None, None] * self.K, weight)
        forms = np.stack([self.K + self._weighted_form(m) for m in M])
        return Tangent(weight[:, None, None] * forms, weight)

    def _weighted_form(self, M: Array) -> Array:
        """Weighted mean of the forms, each the heavier the larger it is, (R, R)."""
        assert self.roots is not None
        each, along = self._each(M)
        share = (np.maximum(each, 0.0) / max(float(each.max()), 1e-300)) ** (self.sharpness - 1.0)
        share = share / share.sum()
        if self.is_spectral:
            return np.asarray((along * share) @ along.T, dtype=np.float64)
        loud = share > 1e-6 * share.max()  # what is left out makes the sum less than one: no harm
        flat = np.moveaxis(self.roots[loud] * np.sqrt(share[loud])[:, None, None], 1, 0)
        flat = flat.reshape(len(M), -1)
        return np.asarray(flat @ flat.T, dtype=np.float64)


def _worst_weights(values: Array, tail: float) -> Array:
    """Weights, (S,), with which the mean of the values is that over the worst share of them."""
    count = len(values)
    if tail >= 1.0 or count == 1:
        return np.full(count, 1.0 / count)
    most = 1.0 / (tail * count)
    weight = np.zeros(count)
    left = 1.0
    for s in np.argsort(-values, kind="stable"):
        weight[s] = min(most, left)
        left -= weight[s]
    return weight


def purpose(G: Array, W: Array, prior_sd: Array) -> DesignCriterion:
    """To predict the tool point at M poses, on average (I).

    Directions that neither move the tool point at any pose nor show in any row stay at their prior
    whatever is measured; they are left out, which is exact and a third of the work.

    Args:
        G: Deviation of the tip per unit of every parameter at the poses, (M, 3, P), mm.
        W: Some whitened rows that span what can be measured, (N, P).
        prior_sd: Expected standard deviation of every parameter, (P,).
    """
    scaled = (G * prior_sd).reshape(-1, len(prior_sd))
    K = scaled.T @ scaled / len(G)
    seen = W.T @ W
    both = K / np.trace(K) + seen / max(float(np.trace(seen)), 1e-300)
    values, vectors = np.linalg.eigh(both)
    V = vectors[:, values > _SHOWN * values[-1]]
    return DesignCriterion(V, V.T @ K @ V)


def determinant(aim: DesignCriterion) -> DesignCriterion:
    """To shrink the volume of what stays unknown (Bayesian D)."""
    return replace(aim, is_determinant=True, roots=None)


def parameters(aim: DesignCriterion) -> DesignCriterion:
    """To know the parameters, in units of their prior, on average (A)."""
    return replace(aim, K=np.eye(len(aim.K)), is_determinant=False, roots=None)


def worst_pose(aim: DesignCriterion, G: Array, prior_sd: Array) -> DesignCriterion:
    """To predict the tool point at the worst of M poses (worst-case I; G in the books).

    Args:
        aim: An I-criterion of the same directions.
        G: Deviation of the tip per unit of every parameter at the poses, (M, 3, P), mm.
        prior_sd: Expected standard deviation of every parameter, (P,).
    """
    roots = np.einsum("mip,pr->mri", G * prior_sd, aim.directions)
    return replace(aim, K=np.zeros_like(aim.K), is_determinant=False, roots=roots)


def worst_pattern(aim: DesignCriterion) -> DesignCriterion:
    """To leave no pattern of errors large, large as the tool point feels it (E).

    Largest eigenvalue of ``r^T M^-1 r`` with K = r r^T: the variance, mean over the poses, of the
    error pattern that is known worst. With K the unit matrix it is the E-criterion of the books.
    """
    values, vectors = np.linalg.eigh(aim.K)
    kept = values > _SHOWN * values[-1]
    root = vectors[:, kept] * np.sqrt(values[kept])
    zero = np.zeros_like(aim.K)
    return replace(aim, K=zero, is_determinant=False, roots=root[None], is_spectral=True)


def robust(aim: DesignCriterion, scale: Array, tail: float = 1.0) -> DesignCriterion:
    """The same purpose for machines whose errors are larger or smaller than expected.

    Args:
        aim: Any purpose without potential terms.
        scale: Size of every parameter of S drawn machines over its expected one, (S, P).
        tail: Share of the machines, the worst, over which is averaged.

    Raises:
        DesignError: A scale that is not positive: where the prior knows a parameter for certain,
            there is no inverse covariance.
    """
    if not np.all(scale > 0.0):
        raise DesignError("scales of drawn machines: found zero or less, expected above zero")
    V = aim.directions
    unit = np.eye(V.shape[1])
    priors = [np.linalg.solve((V.T * s**2) @ V, unit) for s in scale]
    return replace(aim, priors=np.stack([0.5 * (p + p.T) for p in priors]), tail=tail)


def with_potential(aim: DesignCriterion, count: int, worth: float) -> DesignCriterion:
    """The same purpose with potential terms: columns of effects that may be there or not.

    Rows have `count` columns more, standardised and times their small prior standard deviation;
    for D they join the determinant, else the mean of their posterior over prior variances counts,
    `worth` mm^2 when nothing is known of them.

    Args:
        aim: Any purpose over the primary terms.
        count: Number of potential terms, Q.
        worth: Of the potential terms, mm^2.

    Reference:
        DuMouchel and Jones, Technometrics 36 (1994) 37.
    """
    R = len(aim.K)
    K = np.zeros((R + count, R + count))
    K[:R, :R] = aim.K
    if count:
        K[R:, R:] = worth / count * np.eye(count)
    roots = aim.roots
    if roots is not None:
        roots = np.concatenate([roots, np.zeros((len(roots), count, roots.shape[2]))], axis=1)
    priors = None
    if aim.priors is not None:
        priors = np.zeros((len(aim.priors), R + count, R + count))
        priors[:, :R, :R] = aim.priors
        priors[:, R:, R:] = np.eye(count)
    return replace(aim, K=K, roots=roots, priors=priors)


def without_potential(aim: DesignCriterion) -> DesignCriterion:
    """The same purpose over the primary terms alone."""
    R = aim.directions.shape[1]
    roots = None if aim.roots is None else aim.roots[:, :R]
    priors = None if aim.priors is None else aim.priors[:, :R, :R]
    return replace(aim, K=aim.K[:R, :R], roots=roots, priors=priors)
