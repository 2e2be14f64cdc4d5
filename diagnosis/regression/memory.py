"""Noise that remembers: every touch keeps a share of what was wrong with the one before.

A wandering residual that is sampled often is few independent observations, not many. With
correlation ``a_i`` to the touch before, ``z_i = (e_i - a_i e_before) / sqrt(1 - a_i^2)`` is white
again; columns and deviations are filtered alike, and every test downstream holds as it stands.
"""

from collections.abc import Callable, Iterator
from dataclasses import dataclass
from functools import cached_property

import numpy as np
from scipy.linalg import solve_banded
from scipy.optimize import minimize_scalar

from matstd.diagnosis.regression.linear import below
from matstd.diagnosis.regression.noise import PRIOR_DOF
from matstd.twin.frames import Array, IntArray, Mask
from matstd.twin.record import Touches

MAX_ROWS_MEMORY = 2500
"""Most rows that a memory is estimated from; more would not improve it and take long."""

MEMORY_PASSES = 3  # turns in which the size of the noise settles

MAX_CORRELATION = 0.9995
"""Largest correlation from touch to touch that is tried: beyond, it is no noise but a drift."""


@dataclass(frozen=True, slots=True)
class Memory:
    """A first-order autoregression of the noise, in units of the stated uncertainty."""

    correlation: float  # from one touch to the next, or over `step` seconds
    # s between touches for which it holds; 0 where it goes from touch to touch, whatever the time
    # between them
    step: float = 0.0
    # whether the touch before is the last one at the same point along the same normal (a nest of
    # probes that read together), and not merely the last one
    by_place: bool = False
    # whether rows are freed of it. Of a slow memory, which may be a cause that has no name yet,
    # they are not, since what is slow is what shall be explained; each row then counts for less
    # than one
    is_filtered: bool = True

    @property
    def length(self) -> float:
        """Touches (or steps) after which the correlation is 1/e."""
        return float(-1.0 / np.log(self.correlation))

    @property
    def time(self) -> float | None:
        """The same in s; None where it goes from touch to touch."""
        return self.length * self.step if self.step else None

    @property
    def per_independent(self) -> float:
        """Touches that count as one independent observation of a mean, ``(1 + a)/(1 - a)``."""
        return (1.0 + self.correlation) / (1.0 - self.correlation)


@dataclass(frozen=True, eq=False)
class Whitener:
    """Filter that makes noise with memory white, for the rows of one fit."""

    used: Mask  # rows of the run that the fit uses, n of them, (N,)
    u: Array  # their standard uncertainty, (n,), mm
    # rows such that each, but the first of a chain, stands next to the one before it
    order: IntArray
    before: IntArray  # the row before each, by number among them, -1 for none, (n,)
    kept: Array  # correlation with it, (n,); zero where there is none
    rows: IntArray | None = None  # rows that are kept after the filter, by number; None for all

    def __call__(self, M: Array) -> Array:
        """Columns over all rows of the run (N, K), mm, as whitened columns of the fit."""
        out = self.filtered(M[self.used] / self.u[:, None])
        return out if self.rows is None else out[self.rows]

    def filtered(self, M: Array) -> Array:
        """Values over their uncertainty, (n,) or (n, K), made white."""
        shape = (-1,) + (1,) * (M.ndim - 1)
        kept, alone = self.kept.reshape(shape), self.alone.reshape(shape)
        return np.asarray((M - kept * M[np.maximum(self.before, 0)]) / alone)

    def picked(self, values: Callable[[IntArray], Array], rows: IntArray) -> Array:
        """Values over their uncertainty at some of the rows, (R, K), made white.

        Args:
            values: Values of rows by number; called for these rows and for those before them.
            rows: By number, (R,).
        """
        before = values(np.maximum(self.before[rows], 0))
        return (values(rows) - self.kept[rows, None] * before) / self.alone[rows, None]

    def coloured(self, z: Array) -> Array:
        """Values (n,) that the filter turns into white ones: its inverse."""
        band = np.ones((2, len(z)))
        band[1, :-1] = -self.kept[self.order][1:]
        out = np.empty_like(z)
        out[self.order] = solve_banded((1, 0), band, (z * self.alone)[self.order])
        return out

    @cached_property
    def alone(self) -> Array:
        """Share of a touch that the one before does not predict, ``sqrt(1 - a^2)``, (n,)."""
        return np.sqrt(1.0 - self.kept**2)

    @cached_property
    def log_det(self) -> float:
        """Logarithm of the determinant of the filter."""
        return float(-np.log(self.alone).sum())


def whitener(memory: Memory, touches: Touches, u: Array, used: Mask) -> Whitener:
    """The filter of a memory for the rows that a fit uses.

    Args:
        u: Standard uncertainty of every touch, (N,), mm.
        used: Rows of the fit, (N,).
    """
    order, before, gap = _before(touches, used, memory.by_place)
    steps = gap / memory.step if memory.step else np.ones(len(before))
    kept = np.where(before >= 0, memory.correlation ** np.maximum(steps, 1e-3), 0.0)
    return Whitener(used=used, u=u[used], order=order, before=before, kept=kept)


def _before(touches: Touches, used: Mask, by_place: bool) -> tuple[IntArray, IntArray, Array]:
    """Order of the used rows, the one before each, -1 for none, and the time between, s."""
    rows = np.flatnonzero(used)
    time = touches.time[rows]
    label = _places(touches)[rows] if by_place else np.zeros(len(rows), dtype=np.int64)
    order = np.lexsort((np.arange(len(rows)), time, label))
    before = np.full(len(rows), -1)
    same = label[order][1:] == label[order][:-1]
    before[order[1:][same]] = order[:-1][same]
    gap = time - time[np.maximum(before, 0)]
    return order, before, gap


def _places(touches: Touches) -> IntArray:
    """Number of the point, normal and set-up of every touch, (N,)."""
    key = np.column_stack([np.round(touches.point, 6), np.round(touches.normal, 6), touches.setup])
    return np.unique(key, axis=0, return_inverse=True)[1].reshape(-1)


def _kinds(touches: Touches, used: Mask) -> Iterator[Memory]:
    """Memories that may be: from touch to touch or with time, over all touches or place by place.

    Place by place only where places come again so often that most touches have one before.
    """
    rows = int(used.sum())
    ways = [False]
    if len(np.unique(_places(touches)[used])) * 4 < rows:
        ways.append(True)
    for by_place in ways:
        yield Memory(0.5, 0.0, by_place)
        _, before, gap = _before(touches, used, by_place)
        gaps = gap[(before >= 0) & (gap > 0.0)]
        if len(gaps) > rows // 2 and np.ptp(gaps) > 0.1 * float(np.median(gaps)):
            yield Memory(0.5, float(np.median(gaps)), by_place)


def likely_memory(
    touches: Touches, u: Array, used: Mask, X: Array, y: Array
) -> tuple[Memory, float]:
    """The memory that suits a run best beside a model, and its gain of log likelihood over none.

    The likelihood is that of the deviations with the parameters of the model and the size of the
    noise left open: a residual alone has lost what the fit took with it, and most of a slow memory.

    Args:
        u: Standard uncertainty of every touch, (N,), mm.
        used: Rows that count, (N,).
        X: Columns of the model times the root of their prior over the noise, (N, P), not whitened.
        y: Deviations over the noise, (N,).
    """
    some = _stretch(touches, used)
    X, y = X[some], y[some]
    white = _marginal(X, y, 0.0)
    best = (Memory(0.01), 0.0)
    for kind in _kinds(touches, some):

        def loss(at: float, kind: Memory = kind) -> float:
            filter_ = whitener(_with(kind, at), touches, u, some)
            return -_marginal(filter_.filtered(X), filter_.filtered(y), filter_.log_det)

        # past a correlation of 0.9 its distance from 1 is what matters: atanh spaces both evenly
        bounds = (0.02, float(np.arctanh(MAX_CORRELATION)))
        found = minimize_scalar(loss, bounds=bounds, method="bounded", options={"xatol": 1e-4})
        gain = -float(found.fun) - white
        if gain > best[1]:
            best = (_with(kind, float(found.x)), gain)
    return best


def _stretch(touches: Touches, used: Mask) -> Mask:
    """The used rows, of a long run a stretch in its middle: memory is between neighbours."""
    rows = np.flatnonzero(used)
    rows = rows[np.argsort(touches.time[rows], kind="stable")]
    first = max(len(rows) - MAX_ROWS_MEMORY, 0) // 2
    out = np.zeros_like(used)
    out[rows[first : first + MAX_ROWS_MEMORY]] = True
    return out


def _with(kind: Memory, at: float) -> Memory:
    return Memory(float(np.tanh(at)), kind.step, kind.by_place)


def _marginal(X: Array, y: Array, log_det: float) -> float:
    """Log likelihood of white values y (n,) with columns X (n, P), up to a constant.

    ``-n log s - log det R - (objective + nu)/(2 s^2)`` at the likeliest size s of the noise.
    """
    n, s = len(y), 1.0
    # a column of a prior 1e7 times the noise leaves no digit of the others in their inner products
    whole = np.column_stack([X, y])
    R = below(np.zeros(2 * whole.shape[1:], order="F"), whole)[0]
    prior = np.diag([*np.ones(X.shape[1]), 0.0])
    for remaining in reversed(range(MEMORY_PASSES + 1)):
        own = np.diag(below(prior, R / s, is_triangle=True)[0])
        objective = float(own[-1] ** 2)
        if remaining:
            s *= float(np.sqrt((objective + PRIOR_DOF) / (n + PRIOR_DOF)))
    return -n * float(np.log(s)) - float(np.log(np.abs(own[:-1])).sum()) - 0.5 * objective + log_det
