"""Signatures of effects that are not in the model, free of all that the model can imitate.

A column of an effect says what it does to every touch. What the fitted model could do as well is
projected out of it; the rest is the effect's signature, and the only part of it that a residual can
show. Columns are divided by the noise and scaled by the prior of the effect, so the length of its
signature is how many standard deviations of noise the effect at its usual size stands out by.
"""

from collections.abc import Callable, Hashable, Sequence
from dataclasses import dataclass, field, replace
from functools import cached_property
from itertools import product

import numpy as np

from matstd.diagnosis.fit import Fit
from matstd.diagnosis.regression import PRIOR_DOF, Whitener
from matstd.twin.frames import Array, IntArray, Mask
from matstd.twin.model import Effect, columns, is_tunable
from matstd.twin.record import Touches

Progress = Callable[[float, str], None]
"""Called with the share done and what is being done; only the command line shows it."""

BLOCK = 256  # columns that are projected at a time
MAX_GRID_POINTS = 1000  # most points of the grid of one effect's inner parameters
KEPT_BELOW = 2000  # touches of a run up to which raw columns are kept, some 100 MB


def quiet(share: float, doing: str) -> None:
    """Ignore progress."""


@dataclass(frozen=True, slots=True, eq=False)
class RawColumns:
    """Columns of effects at the touches of one run, those of a short run worked out once.

    Every turn of a search asks for the same ones, while the model that is projected out of them
    differs by a few gross errors. So a diagnosis owns them and passes them to all its projections.
    """

    touches: Touches  # all of the run, since some effects remember what went before
    kept: dict[tuple[Effect, ...], Array] = field(default_factory=dict)

    def of(self, grid: "Grid") -> Array:
        """Columns of a candidate at the points of its grid, (all touches, K), base units."""
        if len(self.touches) > KEPT_BELOW or not isinstance(grid.effect, Hashable):
            return columns(grid.variants, self.touches)
        if grid.variants not in self.kept:
            self.kept[grid.variants] = columns(grid.variants, self.touches)
        return self.kept[grid.variants]


@dataclass(frozen=True, eq=False)
class ResidualSpace:
    """What a fit leaves: the projection on it, and the residual, data and prior rows together."""

    raw: RawColumns  # of effects at all touches of the run
    used: Mask  # which of them the fit uses, N of them
    u: Array  # their standard uncertainty as found, (N,), mm
    Q: Array  # basis of the model, data and prior rows, (N + P, P)
    residual: Array  # data and prior rows, (N + P,)
    dof: float  # degrees of freedom left
    groups: tuple[IntArray, ...]  # rows of every table pose
    gross: Mask
    whitener: Whitener | None = None  # filter of the noise's memory; None for white noise
    # squared residual that the stated size of the noise counts for, as `PRIOR_DOF` observations, in
    # units of the found one
    stated: float = PRIOR_DOF
    independent: float | None = None  # number of independent observations; None for one a touch

    @classmethod
    def of(cls, fit: Fit, raw: RawColumns | None = None) -> "ResidualSpace":
        """What a fit leaves.

        Args:
            raw: Columns at its touches that are shared with other projections; None for none.
        """
        assert raw is None or raw.touches is fit.run.touches
        solution = fit.solution
        Q = np.vstack([solution.Q, solution.root])
        residual = np.concatenate([solution.residual, -solution.phi])
        u = fit.u[fit.used] * fit.weight
        count = len(u) / fit.weight**2
        return cls(
            raw=raw or RawColumns(fit.run.touches),
            used=fit.used,
            u=u,
            Q=Q,
            residual=residual,
            dof=max(solution.dof - len(u) + count, 1.0),
            groups=fit.groups,
            gross=fit.gross.accidents,
            whitener=fit.whitener,
            stated=PRIOR_DOF / (fit.noise.factor * fit.weight) ** 2,
            independent=count if fit.weight > 1.0 else None,
        )

    @property
    def touches(self) -> Touches:
        """All touches of the run."""
        return self.raw.touches

    @property
    def count(self) -> float:
        """Number of independent observations."""
        return float(len(self.u)) if self.independent is None else self.independent

    def thinned(self, count: int) -> "ResidualSpace":
        """The same model fitted to an even choice of so many of the touches."""
        n = len(self.u)
        rows = np.unique(np.linspace(0, n - 1, min(count, n)).astype(np.int64))
        picked = np.concatenate([rows, np.arange(n, len(self.residual))])
        Q = np.linalg.qr(self.Q[picked])[0]
        residual = self.residual[picked]
        residual = residual - Q @ (Q.T @ residual)
        used = np.zeros_like(self.used)
        used[np.flatnonzero(self.used)[rows]] = True
        kept = len(rows)
        dof = kept - float((Q[:kept] ** 2).sum())
        place = np.full(n, -1)
        place[rows] = np.arange(kept)
        groups = tuple(g for g in (place[k][place[k] >= 0] for k in self.groups) if len(g))
        filter_ = None if self.whitener is None else replace(self.whitener, rows=rows)
        thin = replace(self, used=used, u=self.u[rows], Q=Q, residual=residual, dof=dof)
        whole = self.independent
        independent = None if whole is None else whole * kept / n
        return replace(thin, groups=groups, whitener=filter_, independent=independent)

    def columns(self, effects: Sequence[Effect]) -> Array:
        """Whitened columns of effects, scaled by their prior, (N, K)."""
        return self.whitened(columns(effects, self.touches), effects)

    def whitened(self, C: Array, effects: Sequence[Effect]) -> Array:
        """Raw columns of effects (all touches, K) whitened and scaled by their prior, (N, K)."""
        sd = np.array([p.sd for e in effects for p in e.parameters])
        if self.whitener is not None:
            return self.whitener(C * sd)
        return (C if self.used.all() else C[self.used]) * sd / self.u[:, None]

    def project(self, C: Array) -> Array:
        """Columns (N, K) freed of what the model can imitate, (N + P, K)."""
        n = len(C)
        out = self.Q @ -(self.Q[:n].T @ C)
        out[:n] += C
        return out


@dataclass(frozen=True, slots=True, eq=False)
class ScaledEffect:
    """An effect, and how many times larger than usual it is taken to be."""

    effect: Effect
    scale: float = 1.0  # factor on the prior standard deviations of its parameters


def projected(complement: ResidualSpace, sized: Sequence[ScaledEffect]) -> Array:
    """Projected, whitened, scaled columns of effects at their present tuning, (N + P, K)."""
    if not sized:
        return np.zeros((len(complement.residual), 0))
    C = complement.columns([s.effect for s in sized])
    scale = np.repeat([s.scale for s in sized], [len(s.effect.parameters) for s in sized])
    return complement.project(C * scale)


def tuned_variants(effect: Effect, touches: Touches) -> list[Effect]:
    """The effect at every point of the grid of its inner parameters."""
    if not is_tunable(effect):
        return [effect]
    grids = [np.asarray(inner.grid, dtype=float) for inner in effect.inner(touches)]
    points = list(product(*grids))
    step = max(1, -(-len(points) // MAX_GRID_POINTS))
    return [effect.tuned(*(float(v) for v in point)) for point in points[::step]] or [effect]


@dataclass(frozen=True, eq=False)
class Signatures:
    """Projected columns of many variants, side by side."""

    complement: ResidualSpace
    variants: tuple[Effect, ...]  # effects, one for every point of every grid
    owner: IntArray  # index of the candidate that a variant belongs to, (V,)
    names: tuple[str, ...]
    C: Array  # projected, whitened, scaled columns, (N + P, M)
    start: IntArray  # first column of every variant, (V + 1,)
    size: Array  # norm of every column before the projection, (M,)
    tries: IntArray  # points of its grid that every candidate was tried at, here or in a screening
    tried: int  # number of candidates that were tried altogether

    @cached_property
    def width(self) -> IntArray:
        """Number of columns of every variant, (V,)."""
        return np.diff(self.start)

    @cached_property
    def by_width(self) -> dict[int, tuple[IntArray, IntArray]]:
        """For every width k the variants (V_k,) and their columns (V_k, k)."""
        out = {}
        for k in np.unique(self.width):
            which = np.flatnonzero(self.width == k)
            out[int(k)] = (which, self.start[which][:, None] + np.arange(k))
        return out

    @cached_property
    def gram(self) -> dict[int, Array]:
        """For every width k the inner products (V_k, k, k) of each variant's columns."""
        out = {}
        for k, (which, cols) in self.by_width.items():
            S = np.empty((len(which), k, k))
            for i in range(k):
                for j in range(i, k):
                    S[:, i, j] = S[:, j, i] = _inner(self.C, cols[:, i], cols[:, j])
            out[k] = S
        return out

    @cached_property
    def along(self) -> Array:
        """Inner product of every column with the residual, (M,)."""
        return np.asarray(self.C.T @ self.complement.residual)

    def without(self, is_left_out: Callable[[Effect], bool]) -> "Signatures":
        """The same less some candidates, which must be the last ones."""
        kept = sum(not is_left_out(v) for v in self.variants)
        owners, width = int(self.owner[kept - 1]) + 1 if kept else 0, int(self.start[kept])
        assert not any(map(is_left_out, self.variants[:kept]))
        return replace(
            self,
            variants=self.variants[:kept],
            owner=self.owner[:kept],
            names=self.names[:owners],
            C=self.C[:, :width],
            start=self.start[: kept + 1],
            size=self.size[:width],
            tries=self.tries[:owners],
        )

    def first_of_each(self, order: IntArray) -> IntArray:
        """Of variants in some order the first of every candidate, in that order."""
        _, first = np.unique(self.owner[order], return_index=True)
        return np.asarray(order[np.sort(first)])


def _inner(C: Array, left: IntArray, right: IntArray) -> Array:
    """Inner products of pairs of columns, in blocks."""
    out = np.empty(len(left))
    for start in range(0, len(left), BLOCK):
        a, b = C[:, left[start : start + BLOCK]], C[:, right[start : start + BLOCK]]
        out[start : start + BLOCK] = np.einsum("nv,nv->v", a, b)
    return out


@dataclass(frozen=True, slots=True, eq=False)
class Grid:
    """A candidate at the points of its grid."""

    effect: Effect
    variants: tuple[Effect, ...]  # at every point that is kept
    tries: int  # points that were tried, kept or not


def blocks(variants: Sequence[Effect]) -> list[tuple[int, int]]:
    """First and last variant of blocks of about `BLOCK` columns."""
    width = np.cumsum([len(e.parameters) for e in variants])
    out = []
    first = 0
    while first < len(variants):
        before = int(width[first - 1]) if first else 0
        last = max(int(np.searchsorted(width, before + BLOCK, side="right")), first + 1)
        out.append((first, last))
        first = last
    return out


def signatures(
    complement: ResidualSpace, grids: Sequence[Grid], tried: int, progress: Progress = quiet
) -> Signatures:
    """Signatures of candidates at the points of their grids.

    Args:
        tried: Number of candidates that were tried altogether, those of a screening included.
    """
    variants = [v for grid in grids for v in grid.variants]
    owner = np.repeat(np.arange(len(grids)), [len(grid.variants) for grid in grids])
    widths = [len(e.parameters) for e in variants]
    start = np.concatenate([[0], np.cumsum(widths)]).astype(np.int64)
    C = np.empty((len(complement.residual), int(start[-1])), order="F")
    raw = C[: len(complement.u)]
    first = 0
    for grid in grids:
        own = complement.whitened(complement.raw.of(grid), grid.variants)
        raw[:, first : first + own.shape[1]] = own
        first += own.shape[1]
    size = np.linalg.norm(raw, axis=0)
    for first, last in blocks(variants):
        C[:, start[first] : start[last]] = complement.project(raw[:, start[first] : start[last]])
        progress(last / len(variants), "signatures of effects")
    return Signatures(
        complement=complement,
        variants=tuple(variants),
        owner=owner,
        names=tuple(grid.effect.name for grid in grids),
        C=C,
        start=start,
        size=size,
        tries=np.array([grid.tries for grid in grids], dtype=np.int64),
        tried=tried,
    )
