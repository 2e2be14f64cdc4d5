"""Matrices of which the errors of any set of effects follow, at any size of the noise.

For columns ``C = [A, y]`` (n, K + 1), freed of the base as ``B = M C``, and noise of s times the
stated one, kept are

- ``G = C^T B``, ``H2 = B^T B``, ``H1 = B^T u^2 B / n``, ``H3`` of `Base.new_run_square`;
- of every group of rows left out ``F = B_g^T (M_gg)^-1 B_g``;
- the freedom of the base and its part of the error in a new run.

With a set of columns T (each a mix of the stored ones) all become ``T^T . T``; then
``a = (G_aa + w^2)^-1 G_ay`` estimates, ``c = (-a, 1)``, and the errors are quadratic forms of c
(`Reduced.errors`). They are identities: nothing is approximated but the course over log s, a
series of Chebyshev's polynomials through a few sizes of the noise. Its relative error is below
`MAX_ERROR`. Its coefficients fall by a tenth or more from one order to the next, so that a page
can keep the higher ones with fewer digits.
"""

from collections.abc import Callable, Sequence
from dataclasses import dataclass, fields

import numpy as np
from scipy.linalg import solve_triangular

from matstd.diagnosis.fit import MAX_PASSES, SETTLED_CHANGE
from matstd.diagnosis.reduced.base import Base
from matstd.diagnosis.regression import noise_factor
from matstd.twin.frames import Array

MAX_ERROR = 1e-6
"""Relative error of the series of weights. Of an error it is a hundredth or less: hardly a
parameter is decided by its prior and by the touches alike."""

MOST_TERMS = 12

MARGIN = 0.06
"""Share by which the series reaches beyond the sizes of the noise that sets of effects leave."""


@dataclass(frozen=True, eq=False)
class Matrices:
    """The matrices at one size of the noise, or one term of their series."""

    G: Array  # shape (K + 1, K + 1), as all matrices; columns over the stated uncertainty
    H1: Array  # mm^2
    H2: Array
    H3: Array  # mm^2, (K, K)
    F: Array  # of every group left out, (groups, K + 1, K + 1); none where the file holds rows out
    # ``B^T u^2 B / m`` of the rows that the file marks as held out, mm^2; (0, 0) where there are
    # none
    tested: Array
    freedom: float  # effective number of parameters of the base
    new_run: float  # of `Base.new_run`, mm^2


def _weighted(weights: Array, parts: Sequence[Matrices]) -> Matrices:
    """Sum of matrices times their weights."""
    names = [f.name for f in fields(Matrices)]
    return Matrices(
        **{n: sum(w * getattr(p, n) for w, p in zip(weights, parts, strict=True)) for n in names}
    )


@dataclass(frozen=True, eq=False)
class Errors:
    """Errors of one set of effects."""

    fitted: float  # as `Fit.rms`, mm
    held_out: float  # as `Fit.test_rms`, mm
    s: float  # noise over the stated one
    estimate: Array  # of the columns of the set, in units of their prior, (k,)


@dataclass(frozen=True, eq=False)
class Reduced:
    """A run and a base, of which every set of effects can be fitted without the touches."""

    first: Matrices  # at the stated noise, with which every fit begins
    # coefficients of Chebyshev's polynomials in log s, the constant first
    terms: tuple[Matrices, ...]
    span: tuple[float, float]  # smallest and largest size of the noise that the series serves
    is_tested: bool  # whether the file marks rows as held out
    count: int  # rows used
    weight: float  # factor on the uncertainty of a row, as of `Fit.weight`

    def errors(self, T: Array) -> Errors:
        """Fit a set of columns: the loop of `fit_run`, from the matrices alone.

        Args:
            T: Columns of the set as mixes of the stored ones; the last one is y, (K + 1, k + 1).
        """
        s, here = 1.0, self.first
        for remaining in reversed(range(MAX_PASSES)):
            whole = s * self.weight
            G, H2 = T.T @ here.G @ T, T.T @ here.H2 @ T
            S = G[:-1, :-1] + whole**2 * np.eye(len(G) - 1)
            a: Array = np.linalg.solve(S, G[:-1, -1]).astype(np.float64)
            c = np.append(-a, 1.0)
            dof = self.count - here.freedom - np.trace(np.linalg.solve(S, H2[:-1, :-1]))
            better = noise_factor(float(c @ H2 @ c), float(dof))
            if abs(better / s - 1.0) < SETTLED_CHANGE or not remaining:
                break
            s = better
            here = self.at(s)
        fitted = np.sqrt(max(float(c @ T.T @ here.H1 @ T @ c), 0.0))
        return Errors(float(fitted), self._held_out(T, S, c, here), s, a)

    def _held_out(self, T: Array, S: Array, c: Array, here: Matrices) -> float:
        """As `Fit.test_rms`, mm."""
        if self.is_tested:
            return float(np.sqrt(max(float(c @ T.T @ here.tested @ T @ c), 0.0)))
        squared = 0.0
        for F_g in here.F:
            F = T.T @ F_g @ T
            v = (F @ c)[:-1]
            squared += float(c @ F @ c + v @ np.linalg.solve(S - F[:-1, :-1], v))
        H3 = T[:-1, :-1].T @ here.H3 @ T[:-1, :-1]
        new_run = here.new_run + self.weight**2 * np.trace(np.linalg.solve(S, H3))
        return float(np.sqrt(max(squared / self.count * new_run, 0.0)))

    def at(self, s: float) -> Matrices:
        """The matrices at a size of the noise; beyond the span those of its end."""
        low, high = np.log(self.span)
        x = float(np.clip((2.0 * np.log(s) - low - high) / (high - low), -1.0, 1.0))
        return _weighted(np.cos(np.arange(len(self.terms)) * np.arccos(x)), self.terms)


def matrices(base: Base, C: Array, s: float) -> Matrices:
    """The matrices of columns C = [A, y] of all rows, (N, K + 1), at a size of the noise."""
    fit, whole = base.fit, s * base.fit.weight
    used = C[fit.used]
    B = base.freed(used, whole)
    shown = base.coloured(B) * fit.run.u[fit.used, None]
    is_tested = bool(fit.test_rows.any())
    tested = base.residuals(C, whole)[fit.test_rows] if is_tested else np.zeros((0, 0))
    return Matrices(
        G=used.T @ B,
        H1=shown.T @ shown / len(used),
        H2=B.T @ B,
        H3=base.new_run_square(used[:, :-1], whole),
        F=np.zeros((0, *2 * (C.shape[1],))) if is_tested else _left_out(base, B, whole),
        tested=tested.T @ tested / max(len(tested), 1),
        freedom=float(base.shrunk(whole).sum()),
        new_run=base.new_run(whole),
    )


def _left_out(base: Base, B: Array, whole: float) -> Array:
    """``B_g^T (M_gg)^-1 B_g`` of every group, the smaller of two matrices factorised."""
    root = np.sqrt(base.shrunk(whole))
    out = []
    for rows in base.fit.groups:
        part, here = base.Q[rows] * root, B[rows]
        if len(rows) <= part.shape[1]:
            L = np.linalg.cholesky(np.eye(len(rows)) - part @ part.T)
            W = solve_triangular(L, here, lower=True, check_finite=False)
            out.append(W.T @ W)
        else:
            L = np.linalg.cholesky(np.eye(part.shape[1]) - part.T @ part)
            W = solve_triangular(L, part.T @ here, lower=True, check_finite=False)
            out.append(here.T @ here + W.T @ W)
    return np.array(out)


def reduced(base: Base, C: Array, sets: Sequence[Array]) -> Reduced:
    """Reduce a run to matrices that serve all sets of some columns.

    Args:
        base: What is always refitted.
        C: Columns over the stated uncertainty and times their prior, the deviation last, all rows,
            (N, K + 1).
        sets: Some sets as `Reduced.errors` takes them; the series reaches as far as they do.
    """
    fit = base.fit
    first, count = matrices(base, C, 1.0), int(fit.used.sum())
    span = _span(base, C[fit.used], first, sets)
    return Reduced(
        first=first,
        terms=_series(lambda s: matrices(base, C, s), span),
        span=span,
        is_tested=bool(fit.test_rows.any()),
        count=count,
        weight=fit.weight,
    )


def _span(base: Base, C: Array, first: Matrices, sets: Sequence[Array]) -> tuple[float, float]:
    """Smallest and largest size of the noise that the sets leave, with a margin."""
    found, weight = [], base.fit.weight
    for T in sets:
        G, H2 = T.T @ first.G @ T, T.T @ first.H2 @ T
        S = G[:-1, :-1] + weight**2 * np.eye(len(G) - 1)
        c = np.append(-np.linalg.solve(S, G[:-1, -1]), 1.0)
        dof = len(C) - first.freedom - np.trace(np.linalg.solve(S, H2[:-1, :-1]))
        found.append(noise_factor(float(c @ H2 @ c), float(dof)))
        B = base.freed(C, found[-1] * weight) @ T
        a = np.linalg.solve(
            B[:, :-1].T @ B[:, :-1] + (found[-1] * weight) ** 2 * np.eye(len(G) - 1),
            B[:, :-1].T @ B[:, -1],
        )
        left = B[:, -1] - B[:, :-1] @ a
        found.append(noise_factor(float(left @ left), float(dof)))
    return (1.0 - MARGIN) * min(found), (1.0 + MARGIN) * max(found)


def _series(at: Callable[[float], Matrices], span: tuple[float, float]) -> tuple[Matrices, ...]:
    """Coefficients of Chebyshev's polynomials through matrices at his places in log s.

    ``1 / (1 + (sigma / s)^2)`` has its poles half a pi away from the real axis of log s, which
    gives the rate at which polynomials come nearer, and so the number of terms.
    """
    low, high = np.log(span)
    rate = np.arcsinh(np.pi / (high - low))
    count = int(np.clip(np.ceil(-np.log(MAX_ERROR) / rate), 3, MOST_TERMS))
    angles = np.pi * (np.arange(count) + 0.5) / count
    values = [at(float(np.exp(0.5 * (low + high + (high - low) * x)))) for x in np.cos(angles)]
    shares = np.cos(np.outer(np.arange(count), angles)) * 2.0 / count
    shares[0] /= 2.0
    return tuple(_weighted(row, values) for row in shares)
