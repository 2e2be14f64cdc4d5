"""Criteria for choosing touches: remaining uncertainty over machines and directions.

With ``M_s = prior_s + F`` for the information ``F = W^T W`` of the touches and the prior of a drawn
machine s, the criterion is the mean of its `matstd.information.criteria.measures.Measure` over the
machines, or over the worst of them (conditional value at risk). Without drawn machines the prior is
the unit matrix. At any F there is a tangent, one for each machine, whose sum is nowhere above the
criterion; searches follow it and bounds rest on it.

Reference:
    Rockafellar and Uryasev, J. Risk 2 (2000) 21 (means over the worst share).
"""

from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np

from matstd.information.criteria.measures import (
    MIN_EIGENVALUE_RATIO,
    Determinant,
    LargestEigenvalue,
    LargestVariance,
    MeanVariance,
    Measure,
)
from matstd.information.criteria.tangents import Tangent
from matstd.twin.errors import DesignError
from matstd.twin.frames import Array


@dataclass(frozen=True, eq=False)
class DesignCriterion:
    """A criterion over the relevant directions of parameter space; smaller is better."""

    directions: Array  # orthonormal columns, (P, R'): all that moves a tool point or a touch
    measure: Measure  # of the uncertainty of one machine, over R directions and potential terms
    # inverse covariances of drawn machines, (S, R, R); None for the unit matrix
    priors: Array | None = None
    tail: float = 1.0  # share of the machines, the worst, over which is averaged; 1 for all
    # the same without potential terms; None where there are none
    primary: "DesignCriterion | None" = None

    def __post_init__(self) -> None:
        if not 0.0 < self.tail <= 1.0:
            raise DesignError(f"tail {self.tail:g} of the machines, expected above 0 and up to 1")

    @property
    def size(self) -> int:
        """R, directions and potential terms."""
        return self.measure.size

    @cached_property
    def prior(self) -> Array:
        """Inverse prior covariance of every machine, (S, R, R)."""
        return np.eye(self.size)[None] if self.priors is None else self.priors

    @property
    def is_curved(self) -> bool:
        """Whether the tangent turns as touches come and go."""
        return np.isfinite(self.measure.sharpness) or (self.tail < 1.0 and len(self.prior) > 1)

    def sharper(self, factor: float) -> "DesignCriterion":
        """The same with a mean nearer to the largest, where it has one."""
        return replace(self, measure=self.measure.sharper(factor))

    def rows(self, W: Array) -> Array:
        """Whitened rows (N, P) in the directions that matter, (N, R')."""
        return np.asarray(W @ self.directions)

    def raw(self, information: Array, smooth: bool = False) -> float:
        """Mean over the machines of what the tangents add up to: for D minus the log determinant.

        For the information W^T W of some rows, (R, R); smooth with a power mean for the largest.
        """
        values = np.array([self.measure.value(M, smooth) for M in self.prior + information])
        return float(_worst_weights(values, self.tail) @ values)

    def value(self, information: Array) -> float:
        """Criterion for W^T W (R, R) of some rows: a variance, mm^2, or for D ``det^(-1/R)``."""
        return self.measure.shown(self.raw(information))

    def merit(self, information: Array) -> float:
        """As `value`, with a power mean for the largest; smooth, for searches."""
        return self.measure.shown(self.raw(information, smooth=True))

    def tangents(self, information: Array) -> tuple[Tangent, ...]:
        """The criterion of every machine as seen from some information (R, R), weights included."""
        M = self.prior + information
        values = np.zeros(len(M))
        if self.tail < 1.0:
            values = np.array([self.measure.value(m) for m in M])
        weight = _worst_weights(values, self.tail)
        return tuple(self.measure.tangent(m, float(w)) for m, w in zip(M, weight, strict=True))


def _worst_weights(values: Array, tail: float) -> Array:
    """Weights, (S,), with which the mean of the values is that over the worst share of them."""
    count = len(values)
    if tail >= 1.0 or count == 1:
        return np.full(count, 1.0 / count)
    most = 1.0 / (tail * count)
    # each of the worst weighs as much as it may, the last of them what is left
    upto = np.minimum(most * np.arange(count + 1), 1.0)
    weight = np.zeros(count)
    weight[np.argsort(-values, kind="stable")] = np.diff(upto)
    return weight


def mean_prediction(G: Array, W: Array, prior_sd: Array) -> DesignCriterion:
    """To predict the tool point at M poses, on average (I).

    Directions that neither move the tool point at any pose nor show in any row keep their prior;
    they are left out, which is exact and saves two thirds of the work.

    Args:
        G: Deviation of the tip per unit of every parameter at the poses, (M, 3, P), mm.
        W: Some whitened rows that span what can be measured, (N, P).
        prior_sd: Expected standard deviation of every parameter, (P,).
    """
    scaled = (G * prior_sd).reshape(-1, len(prior_sd))
    K = scaled.T @ scaled / len(G)
    shown = W.T @ W
    felt_or_shown = K / np.trace(K) + shown / max(float(np.trace(shown)), 1e-300)
    values, vectors = np.linalg.eigh(felt_or_shown)
    V = vectors[:, values > MIN_EIGENVALUE_RATIO * values[-1]]
    return DesignCriterion(V, MeanVariance(V.T @ K @ V))


def five_criteria(G: Array, W: Array, prior_sd: Array) -> dict[str, DesignCriterion]:
    """The criteria I, G, D, A and E over the same directions; arguments as of `mean_prediction`."""
    mean = mean_prediction(G, W, prior_sd)
    V, R = mean.directions, mean.size
    assert isinstance(mean.measure, MeanVariance)
    roots = np.einsum("mip,pr->mri", G * prior_sd, V)
    return {
        "I": mean,
        "G": DesignCriterion(V, LargestVariance(roots, np.zeros((R, R)))),
        "D": DesignCriterion(V, Determinant(R)),
        "A": DesignCriterion(V, MeanVariance(np.eye(R))),
        "E": DesignCriterion(V, LargestEigenvalue.of(mean.measure.K)),
    }


def robust(criterion: DesignCriterion, scale: Array, tail: float) -> DesignCriterion:
    """The same criterion for machines whose errors are larger or smaller than expected.

    Args:
        criterion: Any without potential terms.
        scale: Size of every parameter of S drawn machines over its expected one, (S, P).
        tail: Share of the machines, the worst, over which is averaged.

    Raises:
        DesignError: A scale that is not positive: where the prior knows a parameter for certain,
            there is no inverse covariance.
    """
    if not np.all(scale > 0.0):
        raise DesignError("scales of drawn machines: found zero or less, expected above zero")
    V = criterion.directions
    unit = np.eye(V.shape[1])
    priors = [np.linalg.solve((V.T * s**2) @ V, unit) for s in scale]
    return replace(criterion, priors=np.stack([0.5 * (p + p.T) for p in priors]), tail=tail)


def with_potential(criterion: DesignCriterion, count: int, worth: float) -> DesignCriterion:
    """The same criterion with potential terms: columns of effects that may be there or not.

    Rows have `count` columns more, standardised and times their small prior standard deviation;
    for D they join the determinant, else the mean of their posterior over prior variances counts,
    `worth` mm^2 when nothing is known of them.
    """
    priors, R = criterion.priors, criterion.size
    if priors is not None:
        priors = np.tile(np.eye(R + count), (len(priors), 1, 1))
        priors[:, :R, :R] = criterion.priors
    measure = criterion.measure.extended(count, worth)
    return replace(criterion, measure=measure, priors=priors, primary=criterion)
