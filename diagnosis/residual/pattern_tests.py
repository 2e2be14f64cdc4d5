"""Tests of a residual for smooth patterns: probability, evidence and share of every roughness.

What a pattern has in common with the fitted model and with itself does not depend on the effects
that are beside it: it is worked out once a fit and serves every set of effects.
"""

from collections.abc import Iterator
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from matstd.diagnosis.evidence import EffectSet, ResidualSpace
from matstd.diagnosis.regression import PRIOR_DOF
from matstd.diagnosis.residual.patterns import Pattern, patterns, thinned
from matstd.information.power import exceedance
from matstd.twin.frames import Array, IntArray

PATTERN_VARIANCES = np.geomspace(0.3, 3e4, 11) ** 2
"""Variances of a pattern over the noise variance of one touch that are tried for its evidence."""


@dataclass(frozen=True, slots=True, eq=False)
class Freed:
    """Inner products of the functions of a pattern, freed of a model."""

    gram: Array  # with each other, (K, K)
    along: Array  # with the residual, (K,)

    def scaled(self, spectra: Array) -> Array:
        """`gram` at the expected sizes of every roughness, (L, K, K)."""
        root = np.sqrt(spectra)[:, :, None]
        return np.asarray(root * self.gram * np.swapaxes(root, 1, 2))


@dataclass(frozen=True, eq=False)
class TestedPattern:
    """A pattern with the probability of what its roughnesses hold, and on demand what they hold."""

    __test__ = False

    pattern: Pattern
    effects: EffectSet  # beside which it was looked for
    freed: Freed  # its functions, freed of them
    p: Array  # probability of so much in white noise, not corrected, (L,)
    rows: float  # touches in use over those that were looked at

    @cached_property
    def _principal(self) -> tuple[Array, Array]:
        """Eigenvalues of every roughness and squared parts along its eigenvectors, (L, K) each."""
        values, vectors = np.linalg.eigh(self.freed.scaled(self.pattern.spectra))
        along = np.sqrt(self.pattern.spectra) * self.freed.along
        return np.maximum(values, 0.0), np.einsum("lkj,lk->lj", vectors, along) ** 2

    @cached_property
    def _at_sizes(self) -> tuple[Array, Array]:
        """Sizes that are tried (T,), variances over that of the noise, and log evidence (T, L)."""
        values, along = self._principal
        sizes = PATTERN_VARIANCES / max(float(np.mean(values.sum(axis=1))), 1e-300)
        scaled = sizes[:, None, None]
        fall = (scaled * along / (1.0 + scaled * values)).sum(axis=2)
        charge = np.log1p(scaled * values).sum(axis=2)
        complement, objective = self.effects.complement, self.effects.objective
        left = np.maximum(objective - fall, 1e-9) + complement.stated
        n = complement.count + PRIOR_DOF
        return sizes, -0.5 * n * np.log(left / (objective + complement.stated)) - 0.5 * charge

    @property
    def evidence(self) -> float:
        """Log evidence at the likeliest size and roughness, against no pattern."""
        return float(self._at_sizes[1].max())

    @property
    def share(self) -> float:
        """Of the squared residual that a roughness holds beyond chance, at most."""
        (values, along), (sizes, evidence) = self._principal, self._at_sizes
        objective = self.effects.objective
        scaled = sizes[np.argmax(evidence, axis=0)][:, None]
        by_chance = values * objective / max(self.effects.dof, 1.0)
        fall = (scaled * (along - by_chance) / (1.0 + scaled * values)).sum(axis=1)
        return float(fall.max()) * self.rows / objective

    def columns(self) -> Array:
        """Projected functions at their likeliest size, (N + P, K)."""
        complement, (sizes, evidence) = self.effects.complement, self._at_sizes
        best, roughness = np.unravel_index(int(np.argmax(evidence.T)), evidence.T.shape)[::-1]
        scale = np.sqrt(self.pattern.spectra[roughness] * sizes[best])
        every = np.arange(len(complement.u))
        return complement.project(self.pattern.whitened(complement, every) * scale)


@dataclass(frozen=True, eq=False)
class PatternTests:
    """All patterns of a run, ready to be looked for in what any set of effects leaves."""

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
    def _functions(self) -> tuple[Array, ...]:
        """Functions of every pattern at these touches, (R, K) each."""
        return tuple(p.whitened(self.complement, self.rows) for p in self.known)

    @cached_property
    def _freed(self) -> tuple[Freed, ...]:
        """Every pattern freed of the fitted model."""
        Q, residual = self.complement.Q[self.rows], self.complement.residual[self.rows]
        out = []
        for F in self._functions:
            B = Q.T @ F
            out.append(Freed(F.T @ F - B.T @ B, F.T @ residual))
        return tuple(out)

    def _beside(self, effects: EffectSet) -> Iterator[Freed]:
        """Every pattern freed of the model and of effects."""
        if effects.A.shape[1] == 0:
            yield from self._freed
            return
        A = effects.A[self.rows].T
        for F, freed in zip(self._functions, self._freed, strict=True):
            E = effects.lower_solve(A @ F)
            yield Freed(freed.gram - E.T @ E, freed.along - E.T @ effects.along)

    def of(self, effects: EffectSet) -> list[TestedPattern]:
        """Score tests of every pattern at every roughness.

        The statistic is the squared correlation of the functions with the residual, weighted by the
        spectrum (the score of a random function of that roughness); its distribution in white noise
        after the projection is exact.
        """
        assert effects.complement is self.complement
        freed = list(self._beside(effects))
        values, statistic = [], []
        for pattern, own in zip(self.known, freed, strict=True):
            values.append(np.maximum(np.linalg.eigvalsh(own.scaled(pattern.spectra)), 0.0))
            statistic.append((pattern.spectra * own.along**2).sum(axis=1))
        share = len(self.complement.u) / len(self.rows)
        probabilities = _probabilities(effects, values, statistic)
        return [
            TestedPattern(pattern=pattern, effects=effects, freed=own, p=p, rows=share)
            for pattern, own, p in zip(self.known, freed, probabilities, strict=True)
        ]


def _probabilities(
    effects: EffectSet, values: list[Array], statistic: list[Array]
) -> Iterator[Array]:
    """Of every pattern by its eigenvalues (L, K) and statistics (L,), all in one go."""
    if not values:
        return iter(())
    widest = max(v.shape[1] for v in values)
    weights = np.vstack([np.pad(v, ((0, 0), (0, widest - v.shape[1]))) for v in values])
    p = ratio_probability(np.concatenate(statistic) / effects.objective, weights, effects.dof)
    return iter(np.split(p, np.cumsum([len(v) for v in values])[:-1]))


def ratio_probability(statistic: Array, weights: Array, dof: float) -> Array:
    """Probability that ``sum_i w_i z_i^2 / sum_j z_j^2`` is at least as large as observed.

    The z_j are dof independent standard normal numbers, of which the weights count the first ones.
    The event is ``sum_i (w_i - c) z_i^2 - c sum_rest z^2 > 0``, a quadratic form (`exceedance`).

    Args:
        statistic: Observed ratios c, shape (S,).
        weights: Non-negative, shape (S, K); zeros may pad them.
        dof: Number of normal numbers altogether; of more weights than that the largest count.

    Returns:
        Shape (S,).
    """
    c = np.asarray(statistic, dtype=float)[:, None]
    if weights.shape[1] > dof:
        weights = -np.sort(-weights, axis=1)[:, : max(int(dof), 1)]
    a = np.concatenate([weights - c, -c], axis=1)
    count = np.ones_like(a)
    count[:, -1] = max(float(dof) - weights.shape[1], 0.0)
    out = np.where(c[:, 0] > 0.0, 0.0, 1.0)
    possible = (out < 1.0) & (a.max(axis=1) > 1e-12 * c[:, 0])
    if possible.any():
        out[possible] = exceedance(a[possible], np.zeros_like(a[:1]), 0.0, count[possible])
    return np.clip(out, 1e-300, 1.0)
