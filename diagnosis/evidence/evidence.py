"""How much a set of further effects explains: objective, evidence, tests, all in one projection."""

from dataclasses import dataclass
from functools import cached_property

import numpy as np
from scipy.linalg import cho_factor, cho_solve, solve_triangular

from matstd.diagnosis.evidence.effect_signatures import ResidualSpace, Signatures
from matstd.diagnosis.regression import PRIOR_DOF, LeftOut, f_probability, left_out
from matstd.twin.frames import Array, IntArray
from matstd.twin.model import Effect

MIN_VISIBLE = 0.25
"""Squared signature per unit of prior, over the noise, below which a direction of an effect's
parameters could not be seen even at its expected size; it is not counted as a degree of freedom."""

SCALES = (1.0, 4.0, 16.0, 64.0, 256.0, 1024.0, 4096.0)
"""How many times larger than usual an effect may be; the likeliest factor is taken.

Sizes count in units of the noise that the starting model leaves, which an effect of thirty times
the true noise inflates as much: beside the true noise it must still be free."""

MIN_OWN_SHARE = 1e-4
"""Share of the square of a signature that model and other effects must leave. With less, its size
is a hundred times as uncertain as it would be alone."""

EVIDENCE_ROUNDING = 1e-6
"""Difference of log evidence that rounding may make: ten thousand times what is seen."""


@dataclass(frozen=True, eq=False)
class EffectSet:
    """A model with a set of further effects in it."""

    complement: ResidualSpace
    A: Array  # their projected columns, (N + P, K); K may be 0

    @cached_property
    def _factor(self) -> Array:
        """Lower triangle of ``A^T A + 1``, the unit matrix being the prior of the effects."""
        G = self.A.T @ self.A + np.eye(self.A.shape[1])
        return np.tril(cho_factor(G, lower=True)[0])

    @cached_property
    def basis(self) -> Array:
        """Data rows of model, effects and residual, (N, P + K + 1)."""
        n = len(self.complement.u)
        parts = (self.complement.Q[:n], self.A[:n], self.complement.residual[:n])
        return np.column_stack(parts)

    def whiten(self, B: Array) -> Array:
        """``L^-1 A^T B``: (K, M) from columns (N + P, M)."""
        return self.lower_solve(self.A.T @ B)

    def lower_solve(self, inside: Array) -> Array:
        """``L^-1`` times inner products with the columns, (K, M)."""
        if len(inside) == 0:
            return inside
        return np.asarray(solve_triangular(self._factor, inside, lower=True, check_finite=False))

    def coefficients(self, b: Array) -> Array:
        """Parameters of the effects that fit a direction b (N + P,) best, (K,)."""
        if self.A.shape[1] == 0:
            return np.zeros(0)
        return np.asarray(cho_solve((self._factor, True), self.A.T @ b, check_finite=False))

    @cached_property
    def along(self) -> Array:
        """``L^-1 A^T r``, (K,)."""
        return self.whiten(self.complement.residual[:, None])[:, 0]

    @cached_property
    def objective(self) -> float:
        """Squared residual with the effects in, prior rows included."""
        r = self.complement.residual
        return float(r @ r - self.along @ self.along)

    @cached_property
    def log_det(self) -> float:
        """Half of it is what the freedom of the effects costs."""
        return float(2.0 * np.log(np.diag(self._factor)).sum()) if self.A.shape[1] else 0.0

    @cached_property
    def evidence(self) -> float:
        """Logarithm of the evidence up to a constant; the size of the noise is integrated out."""
        space = self.complement
        return float(log_evidence(self.objective, self.log_det, space.count, space.stated))

    @cached_property
    def dof(self) -> float:
        """Degrees of freedom left with the effects in."""
        return self.complement.dof - self.A.shape[1]

    @cached_property
    def phi(self) -> Array:
        """Parameters of the effects in units of their prior, (K,)."""
        if self.A.shape[1] == 0:
            return np.zeros(0)
        L = self._factor
        return np.asarray(solve_triangular(L, self.along, lower=True, trans=1, check_finite=False))

    def spread(self, k: int) -> float:
        """Standard deviation of parameter k of the effects, in units of its prior."""
        one = np.zeros(self.A.shape[1])
        one[k] = 1.0
        return float(np.linalg.norm(self.lower_solve(one[:, None])))

    @cached_property
    def residual(self) -> Array:
        """Residual with the effects in, data and prior rows, (N + P,)."""
        return np.asarray(self.complement.residual - self.A @ self.phi)

    @cached_property
    def held_out(self) -> LeftOut:
        """Every table pose predicted by the others, with the effects in; whitened."""
        n = len(self.complement.u)
        Q = self.complement.Q[:n]
        if self.A.shape[1]:
            # columns of the augmented basis: A L^-T is orthonormal together with its prior rows
            extra = solve_triangular(self._factor, self.A[:n].T, lower=True, check_finite=False).T
            Q = np.hstack([Q, extra])
        return left_out(Q, self.residual[:n], self.complement.groups)

    @cached_property
    def held_out_log_density(self) -> float:
        """Logarithm of the predictive density of the held-out poses up to a constant.

        As in `evidence` the size of the noise is integrated out: a second effect is judged beside
        the noise that the first one leaves, not beside that of the model without either.
        """
        left = self.held_out
        space = self.complement
        return float(log_evidence(left.squared, left.log_det, space.count, space.stated))


def log_evidence(
    objective: Array | float, log_det: Array | float, count: float, stated: float
) -> Array:
    """Logarithm of the evidence up to a constant, with a scale-free noise.

    ``-(n + nu)/2 log(objective + nu s^2) - log_det/2``: the marginal likelihood of a normal linear
    model whose noise has an inverse chi-squared prior of nu degrees of freedom about the stated
    size s, in units of the size that the starting model leaves.

    Args:
        count: Number n of independent observations.
        stated: ``nu s^2``.
    """
    objective = np.maximum(objective, 1e-9) + stated
    return -0.5 * (count + PRIOR_DOF) * np.log(objective) - 0.5 * np.asarray(log_det)


@dataclass(frozen=True, slots=True, eq=False)
class Scores:
    """What every variant would do if it came into a set of effects."""

    free_drop: Array  # fall of the squared residual over visible directions, prior aside, (V,)
    freedom: Array  # number of those directions, (V,)
    # log evidence of the set with the variant, (V,); none where `MIN_OWN_SHARE` share or less of
    # its signature is its own
    evidence: Array
    scale: Array  # factor on its usual size that gives most evidence, (V,)
    p: Array  # probability of such a fall by chance, one variant, no correction, (V,)


def ranked(evidence: Array) -> IntArray:
    """Numbers of variants, most evidence first, (V,); of equal ones the first comes first.

    Carriers that act alike at every touch differ by rounding, which must not choose among them.

    Example:
        >>> ranked(np.array([1.0, 2.0, 2.0 + 1e-12, -np.inf, -np.inf])).tolist()
        [1, 2, 0, 3, 4]
    """
    order = np.argsort(-evidence, kind="stable")
    with np.errstate(invalid="ignore"):  # two that cannot be scored
        is_next = np.diff(-evidence[order]) > EVIDENCE_ROUNDING
    level = np.concatenate([[0], np.cumsum(is_next)])[: len(order)]
    return np.asarray(order[np.lexsort((order, level))])


def score_all(effects: EffectSet, pool: Signatures, inside: Array | None = None) -> Scores:
    """Score every variant of a pool as an addition to a set of effects.

    One product of the set's columns with all signatures, then small eigenproblems of the width of
    each variant.

    Args:
        inside: That product, (K, M), where it is known; the touches are then not gone through.
    """
    E = effects.whiten(pool.C) if inside is None else effects.lower_solve(inside)
    return _scores(effects, pool, E, pool.along - E.T @ effects.along, 1.0)


def screen(effects: EffectSet, sample: EffectSet, pool: Signatures, along: Array) -> Scores:
    """Score variants against a long run, with their own lengths from an even choice of touches.

    What a variant has in common with the residual is counted over all touches; its length after
    the projection, which is much more work, over the choice, and scaled up.

    Args:
        sample: The same set over the choice.
        pool: Signatures over the choice.
        along: Inner product of every column with the residual of the set, all touches, (M,).
    """
    share = len(effects.complement.u) / len(sample.complement.u)
    return _scores(effects, pool, sample.whiten(pool.C), along, share)


def _scores(effects: EffectSet, pool: Signatures, E: Array, g: Array, share: float) -> Scores:
    """Scores from inner products: E (K, M) with the set, g (M,) with its residual."""
    count = len(pool.variants)
    free, freedom, evidence = np.zeros(count), np.zeros(count), np.zeros(count)
    scale = np.ones(count)
    for k, (which, cols) in pool.by_width.items():
        own = np.moveaxis(E[:, cols], 0, 1)  # (V_k, K, k)
        S = share * (pool.gram[k] - np.einsum("vai,vaj->vij", own, own))
        values, along = _principal(S, g[cols])
        evidence[which], scale[which] = _scaled_evidence(effects, values, along)
        # beside what is in the set already: a large effect must not hide all smaller ones
        signal, hidden = values * effects.dof, MIN_VISIBLE * effects.objective
        seen = signal > hidden
        # on a machine worse than its class by a thousand nothing is seen at its usual size
        large = signal * scale[which, None] ** 2 > hidden
        seen = np.where(seen.any(axis=1, keepdims=True), seen, large)
        whole = share * (pool.size[cols] ** 2).sum(axis=1)
        is_same = values.sum(axis=1) < MIN_OWN_SHARE * whole
        seen[is_same] = False
        evidence[which[is_same]] = -np.inf
        free[which] = np.where(seen, along / np.where(seen, values, 1.0), 0.0).sum(axis=1)
        freedom[which] = seen.sum(axis=1)
    rest = np.maximum(effects.objective - free, 1e-9)
    p = f_probability(free, freedom, rest, effects.dof - freedom)
    return Scores(
        free_drop=free,
        freedom=freedom,
        evidence=evidence,
        scale=scale,
        p=np.where(freedom > 0, p, 1.0),
    )


def _principal(S: Array, g: Array) -> tuple[Array, Array]:
    """Eigenvalues of S (V, k, k) and squared parts of g (V, k) along its eigenvectors."""
    if S.shape[1] == 1:
        return np.maximum(S[:, 0], 0.0), g**2
    values, vectors = np.linalg.eigh(S)
    return np.maximum(values, 0.0), np.einsum("vij,vi->vj", vectors, g) ** 2


def _scaled_evidence(effects: EffectSet, values: Array, along: Array) -> tuple[Array, Array]:
    """Log evidence (V,) at the likeliest scale (V,)."""
    scales = np.array(SCALES)
    squares = np.square(scales)[:, None, None]
    wide = squares * values
    drop = (squares * along / (1.0 + wide)).sum(axis=2)
    log_det = effects.log_det + np.log1p(wide).sum(axis=2)
    space = effects.complement
    tried = log_evidence(effects.objective - drop, log_det, space.count, space.stated)
    best = np.argmax(tried, axis=0)
    return np.max(tried, axis=0), scales[best]


def addition(effects: EffectSet, effect: Effect) -> tuple[float, float]:
    """Log evidence of a set with one effect more, and the likeliest scale of the effect.

    From inner products alone: what is projected out of its columns is never written down.
    """
    C = effects.complement.columns([effect])
    inside = effects.basis.T @ C
    B, A, r = np.split(inside, [effects.complement.Q.shape[1], len(inside) - 1])
    E = effects.lower_solve(A)
    S = C.T @ C - B.T @ B - E.T @ E
    g = r[0] - E.T @ effects.along
    evidence, scale = _scaled_evidence(effects, *_principal(S[None], g[None]))
    return float(evidence[0]), float(scale[0])
