"""Tests of a residual for smooth patterns: probability, evidence and share of every roughness.

What a pattern has in common with the fitted model and with itself does not depend on the effects
that are beside it: it is worked out once a fit and serves every set of effects.
"""

from collections.abc import Iterator
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from diagnosis.evidence import EffectSet, ResidualSpace
from diagnosis.regression import PRIOR_DOF
from diagnosis.residual.patterns import Pattern, patterns, thinned
from diagnosis.residual.quadratic import ratio_probability
from twin.frames import Array
from twin.record import IntArray

SIZES = np.geomspace(0.3, 3e4, 11) ** 2
"""Variances of a pattern over the noise variance of one touch that are tried for its evidence."""


@dataclass(frozen=True, slots=True, eq=False)
class Freed:
    """Inner products of the functions of a pattern, freed of a model.

    Attributes:
        gram: With each other, (K, K).
        along: With the residual, (K,).
    """

    gram: Array
    along: Array


@dataclass(frozen=True, slots=True, eq=False)
class TestedPattern:
    """A pattern with what its roughnesses hold.

    Attributes:
        pattern: Which one.
        p: Probability of so much in white noise, not corrected, (L,).
        evidence: Log evidence at the likeliest size, (L,).
        size: That size, a variance over that of the noise, (L,).
        share: Of the squared residual that it holds beyond chance, (L,).
    """

    __test__ = False

    pattern: Pattern
    p: Array
    evidence: Array
    size: Array
    share: Array

    def columns(self, complement: ResidualSpace) -> Array:
        """Projected functions at their likeliest size, (N + P, K)."""
        best = int(np.argmax(self.evidence))
        scale = np.sqrt(self.pattern.spectra[best] * self.size[best])
        every = np.arange(len(complement.u))
        return complement.project(self.pattern.whitened(complement, every) * scale)


@dataclass(frozen=True, eq=False)
class PatternTests:
    """All patterns of a run, ready to be looked for in what any set of effects leaves.

    Attributes:
        complement: What the fitted model leaves.
    """

    __test__ = False

    complement: ResidualSpace

    @cached_property
    def rows(self) -> IntArray:
        """Which of the touches in use are looked at, (R,)."""
        return thinned(self.complement)

    @cached_property
    def known(self) -> tuple[Pattern, ...]:
        """Every pattern that the run can show."""
        return tuple(patterns(self.complement.touches))

    @cached_property
    def _freed(self) -> tuple[Freed, ...]:
        """Every pattern freed of the fitted model."""
        Q, residual = self.complement.Q[self.rows], self.complement.residual[self.rows]
        out = []
        for pattern in self.known:
            F = pattern.whitened(self.complement, self.rows)
            B = Q.T @ F
            out.append(Freed(F.T @ F - B.T @ B, F.T @ residual))
        return tuple(out)

    def _beside(self, effects: EffectSet) -> Iterator[Freed]:
        """Every pattern freed of the model and of effects."""
        if effects.A.shape[1] == 0:
            yield from self._freed
            return
        A = effects.A[self.rows].T
        for pattern, freed in zip(self.known, self._freed, strict=True):
            E = effects.lower_solve(A @ pattern.whitened(self.complement, self.rows))
            yield Freed(freed.gram - E.T @ E, freed.along - E.T @ effects.along)

    def of(self, effects: EffectSet) -> list[TestedPattern]:
        """Score tests of every pattern at every roughness.

        The statistic is the squared correlation of the functions with the residual, weighted by the
        spectrum (the score of a random function of that roughness); its distribution in white noise
        after the projection is exact.

        Args:
            effects: Model and effects in it; the model is that of `complement`.
        """
        assert effects.complement is self.complement
        principal = []
        for pattern, freed in zip(self.known, self._beside(effects), strict=True):
            root = np.sqrt(pattern.spectra)[:, :, None]  # (L, K, 1)
            S = root * freed.gram * np.swapaxes(root, 1, 2)
            values, vectors = np.linalg.eigh(S)
            along = np.einsum("lkj,lk->lj", vectors, root[:, :, 0] * freed.along) ** 2
            principal.append((np.maximum(values, 0.0), along))
        probabilities = _probabilities(effects, principal)
        share = len(self.complement.u) / len(self.rows)
        tested = zip(self.known, principal, probabilities, strict=True)
        return [_tested(effects, pattern, *found, p, share) for pattern, found, p in tested]


def _probabilities(effects: EffectSet, principal: list[tuple[Array, Array]]) -> list[Array]:
    """Of every pattern by its eigenvalues and squared parts, (L,) each; all in one go."""
    if not principal:
        return []
    widest = max(values.shape[1] for values, _ in principal)
    weights = [np.pad(v, ((0, 0), (0, widest - v.shape[1]))) for v, _ in principal]
    statistic = np.concatenate([along.sum(axis=1) for _, along in principal]) / effects.objective
    p = ratio_probability(statistic, np.vstack(weights), effects.dof)
    return np.split(p, np.cumsum([len(v) for v, _ in principal])[:-1])


def _tested(
    effects: EffectSet, pattern: Pattern, values: Array, along: Array, p: Array, share: float
) -> TestedPattern:
    """A pattern by its eigenvalues and squared parts (L, K); share: touches in use over those
    looked at.
    """  # noqa: D205
    objective = effects.objective
    sizes = SIZES / max(float(np.mean(values.sum(axis=1))), 1e-300)
    gained = _evidence(effects, values, along, sizes)
    best = np.argmax(gained, axis=0)
    scaled = sizes[best][:, None]
    by_chance = values * objective / max(effects.dof, 1.0)
    fall = (scaled * (along - by_chance) / (1.0 + scaled * values)).sum(axis=1)
    return TestedPattern(
        pattern=pattern,
        p=p,
        evidence=gained[best, np.arange(len(p))],
        size=sizes[best],
        share=fall * share / objective,
    )


def _evidence(effects: EffectSet, values: Array, along: Array, sizes: Array) -> Array:
    """Log evidence of every size (T,) and roughness (L,) against no pattern, (T, L)."""
    scaled = sizes[:, None, None]
    fall = (scaled * along / (1.0 + scaled * values)).sum(axis=2)
    charge = np.log1p(scaled * values).sum(axis=2)
    n = effects.complement.count + PRIOR_DOF
    stated = effects.complement.stated
    left = np.maximum(effects.objective - fall, 1e-9) + stated
    return np.asarray(-0.5 * n * np.log(left / (effects.objective + stated)) - 0.5 * charge)
