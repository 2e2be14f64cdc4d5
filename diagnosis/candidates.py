"""Signatures of effects that are not in the model, free of all that the model can imitate."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import cached_property
from itertools import product

import numpy as np
from numpy.typing import NDArray

from diagnosis.fit import Fit
from diagnosis.linear import BoolArray
from twin.effect import Effect, Tunable
from twin.frames import Array
from twin.model import columns
from twin.touches import Touches

IntArray = NDArray[np.int64]
Progress = Callable[[float, str], None]
"""Called with the share done and what is being done; only the command line shows it."""

EXACT_BELOW = 4000
"""Up to this many touches signatures are kept in double precision; beyond in single, which halves
the memory and is enough once the model has been projected out in double precision."""

BLOCK = 256
"""Columns that are projected at a time."""

GRID_MOST = 400
"""Most points of the grid of one effect's inner parameters."""


def quiet(share: float, doing: str) -> None:
    """Progress that nobody watches."""


@dataclass(frozen=True, eq=False)
class Complement:
    """What a fit leaves: the projection on it, and the residual, data and prior rows together.

    Attributes:
        touches: All of the run, since some effects remember what went before.
        used: Which of them the fit uses, N of them.
        u: Their standard uncertainty as found, (N,), mm.
        Q: Basis of the model, data and prior rows, (N + P, P).
        residual: Data and prior rows, (N + P,).
        dof: Degrees of freedom left.
        groups: Rows of every table pose.
    """

    touches: Touches
    used: BoolArray
    u: Array
    Q: Array
    residual: Array
    dof: float
    groups: tuple[IntArray, ...]

    @classmethod
    def of(cls, fit: Fit) -> "Complement":
        """The complement of a fit."""
        solution = fit.solution
        Q = np.vstack([solution.Q, solution.root])
        residual = np.concatenate([solution.residual, -solution.phi])
        u = fit.u[fit.used]
        return cls(fit.run.touches, fit.used, u, Q, residual, solution.dof, fit.groups)

    def columns(self, effects: Sequence[Effect]) -> Array:
        """Whitened columns of effects, scaled by their prior, (N, K)."""
        sd = np.array([p.sd for e in effects for p in e.parameters])
        return columns(effects, self.touches)[self.used] * (sd / self.u[:, None])

    def project(self, C: Array) -> Array:
        """Columns (N, K) freed of what the model can imitate, (N + P, K)."""
        n = len(C)
        out = -self.Q @ (self.Q[:n].T @ C)
        out[:n] += C
        return out


@dataclass(frozen=True, slots=True, eq=False)
class Sized:
    """An effect, and how many times larger than usual it is taken to be.

    Attributes:
        effect: With its inner parameters.
        scale: Factor on the prior standard deviations of its parameters.
    """

    effect: Effect
    scale: float = 1.0


def projected(complement: Complement, sized: Sequence[Sized]) -> Array:
    """Projected, whitened, scaled columns of effects at their present tuning, (N + P, K)."""
    if not sized:
        return np.zeros((len(complement.residual), 0))
    C = complement.columns([s.effect for s in sized])
    scale = np.repeat([s.scale for s in sized], [len(s.effect.parameters) for s in sized])
    return complement.project(C * scale)


def tuned_variants(effect: Effect, touches: Touches) -> list[Effect]:
    """The effect at every point of the grid of its inner parameters."""
    if not isinstance(effect, Tunable):
        return [effect]
    grids = [np.asarray(inner.grid, dtype=float) for inner in effect.inner(touches)]
    points = list(product(*grids))
    step = max(1, -(-len(points) // GRID_MOST))
    return [effect.tuned(*(float(v) for v in point)) for point in points[::step]] or [effect]


@dataclass(frozen=True, eq=False)
class Signatures:
    """Projected columns of many variants, side by side.

    Attributes:
        complement: What they are projected on.
        variants: Effects, one for every point of every grid.
        owner: Index of the candidate that a variant belongs to, (V,).
        names: Names of the candidates.
        C: Projected, whitened, scaled columns, (N + P, M).
        start: First column of every variant, (V + 1,).
        size: Norm of every column before the projection, (M,).
    """

    complement: Complement
    variants: tuple[Effect, ...]
    owner: IntArray
    names: tuple[str, ...]
    C: Array
    start: IntArray
    size: Array

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
        return np.asarray(self.C.T @ self.complement.residual.astype(self.C.dtype), dtype=float)

    @cached_property
    def grid_points(self) -> IntArray:
        """Number of variants of every candidate."""
        return np.bincount(self.owner, minlength=len(self.names))

    def columns_of(self, variant: int) -> Array:
        """Projected columns of one variant, (N + P, k), double precision."""
        return np.asarray(self.C[:, self.start[variant] : self.start[variant + 1]], dtype=float)


def _inner(C: Array, left: IntArray, right: IntArray) -> Array:
    """Inner products of pairs of columns, in double precision, in blocks."""
    out = np.empty(len(left))
    for start in range(0, len(left), BLOCK):
        a, b = C[:, left[start : start + BLOCK]], C[:, right[start : start + BLOCK]]
        out[start : start + BLOCK] = np.einsum("nv,nv->v", a, b, dtype=np.float64)
    return out


def signatures(
    complement: Complement, candidates: Sequence[Effect], progress: Progress = quiet
) -> Signatures:
    """Signatures of candidates at every point of their grids.

    Args:
        complement: What the fitted model leaves.
        candidates: Effects that are not in the model.
        progress: Told after every block.
    """
    variants: list[Effect] = []
    owner: list[int] = []
    for index, effect in enumerate(candidates):
        own = tuned_variants(effect, complement.touches)
        variants += own
        owner += [index] * len(own)
    start = np.concatenate([[0], np.cumsum([len(e.parameters) for e in variants])]).astype(np.int64)
    rows = len(complement.residual)
    kind = np.float64 if len(complement.u) <= EXACT_BELOW else np.float32
    C = np.empty((rows, int(start[-1])), dtype=kind, order="F")
    size = np.empty(int(start[-1]))
    first = 0
    while first < len(variants):
        last = int(np.searchsorted(start, start[first] + BLOCK, side="right")) - 1
        last = max(last, first + 1)
        raw = complement.columns(variants[first:last])
        size[start[first] : start[last]] = np.linalg.norm(raw, axis=0)
        C[:, start[first] : start[last]] = complement.project(raw)
        first = last
        progress(first / len(variants), "signatures of effects")
    names = tuple(e.name for e in candidates)
    return Signatures(complement, tuple(variants), np.array(owner), names, C, start, size)
