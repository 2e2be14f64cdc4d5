"""Matrices of which the errors of any set of effects follow, at a few sizes of the noise.

For columns ``C = [A, y]`` (n, K + 1), freed of the base as ``B = M C``, and noise of s times the
stated one, kept are

- ``G = C^T B``, ``H2 = B^T B``, ``H1 = B^T u^2 B / n``, ``H3`` of `Base.new_run_square`;
- of every group of rows left out ``F = B_g^T (M_gg)^-1 B_g``;
- the freedom of the base and its part of the error in a new run.

With a set of columns T (each a mix of the stored ones) all become ``T^T . T``; then
``a = (G_aa + w^2)^-1 G_ay`` estimates, ``c = (-a, 1)``, and the errors are quadratic forms of c
(`Reduced.errors`). They are identities: nothing is approximated but the interpolation over log s,
whose relative error is below `MAX_ERROR`.
"""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from scipy.linalg import solve_triangular

from matstd.diagnosis.fit import MAX_PASSES, SETTLED_CHANGE
from matstd.diagnosis.reduced.base import Base
from matstd.diagnosis.regression import noise_factor
from matstd.twin.frames import Array

MAX_ERROR = 2e-5
"""Relative error of the interpolation of weights between levels. Of an error it is a thousandth:
hardly a parameter is decided by its prior and by the touches alike."""

MOST_LEVELS = 10

MARGIN = 0.06
"""Share by which the levels reach beyond the sizes of the noise that sets of effects leave."""


@dataclass(frozen=True, eq=False)
class Level:
    """The matrices at one size of the noise.

    Attributes:
        s: Noise over the stated one.
        G: Shape (K + 1, K + 1), as all matrices; columns over the stated uncertainty.
        H1: mm^2.
        H3: mm^2, (K, K).
        F: Of every group left out, (groups, K + 1, K + 1).
        freedom: Effective number of parameters of the base.
        new_run: Of `Base.new_run`, mm^2.
    """

    s: float
    G: Array
    H1: Array
    H2: Array
    H3: Array
    F: Array
    freedom: float
    new_run: float


@dataclass(frozen=True, eq=False)
class Errors:
    """Errors of one set of effects.

    Attributes:
        fitted: As `Fit.rms`, mm.
        held_out: As `Fit.test_rms`, mm.
        s: Noise over the stated one.
        estimate: Of the columns of the set, in units of their prior, (k,).
    """

    fitted: float
    held_out: float
    s: float
    estimate: Array


@dataclass(frozen=True, eq=False)
class Reduced:
    """A run and a base, of which every set of effects can be fitted without the touches.

    Attributes:
        first: At the stated noise, with which every fit begins.
        levels: At sizes of the noise, ascending in s.
        tested: ``B^T u^2 B / m`` of the rows that the file marks as held out, at the levels, mm^2;
            empty where there are none.
        count: Rows used.
        weight: Factor on the uncertainty of a row, as of `Fit.weight`.
    """

    first: Level
    levels: tuple[Level, ...]
    tested: tuple[Array, ...]
    count: int
    weight: float

    def errors(self, T: Array) -> Errors:
        """Fit a set of columns: the loop of `fit_run`, from the matrices alone.

        Args:
            T: Columns of the set as mixes of the stored ones; the last one is y, (K + 1, k + 1).
        """
        s, level = 1.0, self.first
        for remaining in reversed(range(MAX_PASSES)):
            whole = s * self.weight
            G, H2 = T.T @ level.G @ T, T.T @ level.H2 @ T
            S = G[:-1, :-1] + whole**2 * np.eye(len(G) - 1)
            a: Array = np.linalg.solve(S, G[:-1, -1]).astype(np.float64)
            c = np.append(-a, 1.0)
            dof = self.count - level.freedom - np.trace(np.linalg.solve(S, H2[:-1, :-1]))
            better = noise_factor(float(c @ H2 @ c), float(dof))
            if abs(better / s - 1.0) < SETTLED_CHANGE or not remaining:
                break
            s = better
            level = self.at(s)
        fitted = np.sqrt(max(float(c @ T.T @ level.H1 @ T @ c), 0.0))
        return Errors(float(fitted), self._held_out(T, S, c, level), s, a)

    def _held_out(self, T: Array, S: Array, c: Array, level: Level) -> float:
        """As `Fit.test_rms`, mm."""
        if self.tested:
            H = np.tensordot(self._shares(level.s), np.array(self.tested), axes=1)
            return float(np.sqrt(max(float(c @ T.T @ H @ T @ c), 0.0)))
        squared = 0.0
        for F_g in level.F:
            F = T.T @ F_g @ T
            v = (F @ c)[:-1]
            squared += float(c @ F @ c + v @ np.linalg.solve(S - F[:-1, :-1], v))
        H3 = T[:-1, :-1].T @ level.H3 @ T[:-1, :-1]
        new_run = level.new_run + self.weight**2 * np.trace(np.linalg.solve(S, H3))
        return float(np.sqrt(max(squared / self.count * new_run, 0.0)))

    def _shares(self, s: float) -> Array:
        """Weights of the levels in a value at a size of the noise: Lagrange in log s."""
        x = np.log([level.s for level in self.levels])
        at = float(np.clip(np.log(s), x[0], x[-1]))
        others = ~np.eye(len(x), dtype=bool)
        return np.array(
            [
                np.prod((at - x[o]) / (x[i] - x[o])) if len(x) > 1 else 1.0
                for i, o in enumerate(others)
            ]
        )

    def at(self, s: float) -> Level:
        """The matrices at a size of the noise."""
        w = self._shares(s)

        def mixed(name: str) -> Array:
            return np.tensordot(w, np.array([getattr(k, name) for k in self.levels]), axes=1)

        return Level(
            s=s,
            G=mixed("G"),
            H1=mixed("H1"),
            H2=mixed("H2"),
            H3=mixed("H3"),
            F=mixed("F"),
            freedom=float(mixed("freedom")),
            new_run=float(mixed("new_run")),
        )


def level(base: Base, C: Array, s: float) -> Level:
    """The matrices of columns C = [A, y] of the rows used, (n, K + 1), at a size of the noise."""
    fit, whole = base.fit, s * base.fit.weight
    B = base.freed(C, whole)
    shown = base.coloured(B) * fit.run.u[fit.used, None]
    return Level(
        s=s,
        G=C.T @ B,
        H1=shown.T @ shown / len(C),
        H2=B.T @ B,
        H3=base.new_run_square(C[:, :-1], whole),
        F=np.zeros((0, *2 * (C.shape[1],))) if fit.test_rows.any() else _left_out(base, B, whole),
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


def reduced(base: Base, A: Array, sets: Sequence[Array]) -> Reduced:
    """Reduce a run to matrices that serve all sets of some columns.

    Args:
        base: What is always refitted.
        A: Columns over the stated uncertainty and times their prior, all rows, (N, K).
        sets: Some sets as `Reduced.errors` takes them; the levels reach as far as they do.
    """
    fit = base.fit
    C = np.column_stack([A, base.y])
    used = C[fit.used]
    rough = Reduced(
        first=level(base, used, 1.0), levels=(), tested=(), count=len(used), weight=fit.weight
    )
    low, high = _range(base, used, rough, sets)
    levels = tuple(level(base, used, s) for s in _nodes(low, high))
    tested: tuple[Array, ...] = ()
    if fit.test_rows.any():
        parts = [base.residuals(C, k.s * fit.weight)[fit.test_rows] for k in levels]
        tested = tuple(B.T @ B / len(B) for B in parts)
    return Reduced(
        first=rough.first, levels=levels, tested=tested, count=len(used), weight=fit.weight
    )


def _range(base: Base, C: Array, rough: Reduced, sets: Sequence[Array]) -> tuple[float, float]:
    """Smallest and largest size of the noise that the sets leave, with a margin."""
    found = []
    for T in sets:
        G, H2 = T.T @ rough.first.G @ T, T.T @ rough.first.H2 @ T
        S = G[:-1, :-1] + rough.weight**2 * np.eye(len(G) - 1)
        c = np.append(-np.linalg.solve(S, G[:-1, -1]), 1.0)
        dof = rough.count - rough.first.freedom - np.trace(np.linalg.solve(S, H2[:-1, :-1]))
        found.append(noise_factor(float(c @ H2 @ c), float(dof)))
        B = base.freed(C, found[-1] * rough.weight) @ T
        a = np.linalg.solve(
            B[:, :-1].T @ B[:, :-1] + (found[-1] * rough.weight) ** 2 * np.eye(len(G) - 1),
            B[:, :-1].T @ B[:, -1],
        )
        left = B[:, -1] - B[:, :-1] @ a
        found.append(noise_factor(float(left @ left), float(dof)))
    return (1.0 - MARGIN) * min(found), (1.0 + MARGIN) * max(found)


def _nodes(low: float, high: float) -> Array:
    """Chebyshev's places in log s; as many as keep the error of analytic weights small.

    ``1 / (1 + (sigma / s)^2)`` has its poles half a pi away from the real axis of log s, which
    gives the rate at which polynomials come nearer.
    """
    half = 0.5 * np.log(high / low)
    rate = np.arcsinh(0.5 * np.pi / half)
    count = int(np.clip(np.ceil(-np.log(MAX_ERROR) / rate), 3, MOST_LEVELS))
    x = -np.cos(np.pi * (np.arange(count) + 0.5) / count)
    # the outermost places are the ends: beyond them nothing is known
    return np.exp(np.log(low) + half * (1.0 + x / abs(x[0])))
