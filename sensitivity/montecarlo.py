"""Volumetric error of many random machines at many poses."""

from dataclasses import dataclass, fields, replace

import numpy as np

from sensitivity.blocks import Progress, blocks, silent
from sensitivity.indices import rms
from sensitivity.lengths import BINS, count_lengths
from sensitivity.sampling import (
    DRAWS_A_CHILD,
    Population,
    coefficients,
    draw,
    drawn_in_chunks,
)
from twin.errors import DesignError
from twin.frames import Array
from twin.model import Model
from twin.touches import at_poses

QUANTILES = (0.5, 0.95, 0.99)
WORST = 0.05
"""Share of the poses that counts as the worst ones of a machine."""

_SPAN = 5.0
"""The histogram of |d| at a pose reaches to this multiple of its root mean square. A sum of many
independent errors exceeds it in less than one case of a million, and then sits in the last bin."""
_POSES_A_BLOCK = 128
_DRAWS_A_LOT = 10 * DRAWS_A_CHILD
_FIRST_LOOK = 2000  # draws before it is asked whether they are enough
_NOTHING = 1e-12  # mm: scale of the histogram where no machine has an error


@dataclass(frozen=True, eq=False)
class Volumetric:
    """Volumetric error |d| of S random machines at N poses, first order, mm.

    Attributes:
        draws: S.
        mean: Shape (N,).
        sd: Shape (N,).
        levels: Probabilities of the quantiles, (Q,).
        quantile: Shape (Q, N).
        recurrence: Share of the machines for which the pose is among the worst 5 %, (N,).
        mean_u: Standard error of the mean by sampling, (N,).
        quantile_u: Standard error of the quantiles by sampling, (Q, N).
        recurrence_u: Standard error of the recurrence by sampling, (N,).
        tolerance: Volumetric error that users allow, mm; infinite where they said nothing.
        exceedance: Share of the machines beyond the tolerance, (N,).
        exceedance_u: Standard error of the exceedance by sampling, (N,).
    """

    draws: int
    mean: Array
    sd: Array
    levels: tuple[float, ...]
    quantile: Array
    recurrence: Array
    mean_u: Array
    quantile_u: Array
    recurrence_u: Array
    tolerance: float
    exceedance: Array
    exceedance_u: Array

    def __getitem__(self, rows: slice) -> "Volumetric":
        """The statistics of some poses."""
        each = {
            f.name: getattr(self, f.name)[..., rows]
            for f in fields(self)
            if f.name not in ("draws", "levels", "tolerance")
        }
        return replace(self, **each)

    @property
    def p95(self) -> Array:
        """95 % of the machines stay below this, (N,), mm."""
        return self.quantile[self.levels.index(0.95)]

    @property
    def achieved(self) -> float:
        """Twice the largest standard error of mean and 95 % quantile at any pose, mm."""
        return 2.0 * float(max(self.mean_u.max(), self.p95_u.max()))

    @property
    def p95_u(self) -> Array:
        """Standard error of `p95`, (N,), mm."""
        return self.quantile_u[self.levels.index(0.95)]


def volumetric(
    population: Population,
    q: Array,
    length: Array | float,
    draws: int,
    rng: np.random.Generator,
    progress: Progress = silent,
    reference: int | None = None,
    tolerance: float = np.inf,
    precision: float = 0.0,
    recurrence: bool = True,
) -> Volumetric:
    """Statistics of the volumetric error over random machines, at every pose.

    The deviations of all machines at all poses are one product of matrices, taken in blocks; of
    each block only sums and a histogram are kept. Memory: 24 K + 8 `DRAWS_A_CHILD` + 8192 bytes a
    pose, K the parameters of `Population.model`. Quantiles are read from 2048 bins up to five times
    the root mean square, so they are off by a quarter of a percent of it at most.

    With a precision it stops as soon as twice the standard error of mean and 95 % quantile is below
    it at every pose: the statistics have stabilised (JCGM 101, 7.9.4, with the standard errors of
    all draws in place of those of batches). `Volumetric.achieved` says what all `draws` reached.

    Args:
        population: What to draw from.
        q: Readings, shape (N, A).
        length: Tool length, scalar or (N,), mm.
        draws: S, or at most S; the result for a seed does not depend on how the work is cut.
        rng: Source of the random numbers.
        progress: Told how many machines are done.
        reference: The worst 5 % are those of the first so many poses, and a later pose counts as
            affected where it reaches their limit; None for all poses.
        tolerance: For the exceedance, mm.
        precision: Half width of mean and 95 % quantile with a coverage of 95 % at which enough is
            known, mm; 0 for all draws.
        recurrence: Whether to look for the worst poses of every machine, which takes longer than
            all the rest; they are not a number otherwise.

    Raises:
        DesignError: Fewer than two draws, or no pose.
    """
    if draws < 2 or not len(q):
        raise DesignError(
            f"{draws} draws at {len(q)} poses; expected two draws and a pose at least"
        )
    G = _first_order(population.model, q, length)
    tally = _Tally(rms(population, q, length), reference or len(q), tolerance)
    a_lot = DRAWS_A_CHILD if recurrence else _DRAWS_A_LOT
    next_look = float(_FIRST_LOOK)
    while tally.count < draws:
        chunk = min(a_lot, draws - tally.count)
        lots = drawn_in_chunks(population, chunk, rng)
        theta = np.concatenate([coefficients(population, lot) for lot in lots]).T.copy()
        if recurrence:
            tally.add(_sizes(G, theta))
        else:
            tally.count_only(G, theta)
        progress("random machines", tally.count, draws)
        if precision > 0.0 and tally.count >= next_look:
            if (found := tally.result(recurrence)).achieved <= precision:
                return found
            next_look *= 1.5
    return tally.result(recurrence)


def _sizes(G: Array, theta: Array) -> Array:
    """|d| of every machine at every pose, (N, s), by blocks."""
    size = np.empty((len(G), theta.shape[1]))
    for rows in blocks(len(G), _POSES_A_BLOCK):
        d = (G[rows].reshape(-1, len(theta)) @ theta).reshape(-1, 3, theta.shape[1])
        size[rows] = np.sqrt(np.einsum("nis,nis->ns", d, d))
    return size


def _first_order(model: Model, q: Array, length: Array | float) -> Array:
    """Deviation of the tip per unit of every parameter, (N, 3, K), in blocks."""
    length = np.broadcast_to(np.asarray(length, dtype=float), (len(q),))
    G = np.empty((len(q), 3, len(model.parameters)))
    for rows in blocks(len(q), 1000):
        G[rows] = model.tip_columns(at_poses(model.chain, q[rows], length[rows]))
    return G


class _Tally:
    """Sums, histogram and recurrence of |d|, lot by lot."""

    def __init__(self, scale: Array, reference: int, tolerance: float) -> None:
        n = len(scale)
        self.width = np.maximum(scale, _NOTHING) * (_SPAN / BINS)
        self.count = 0
        self.sum, self.squares, self.worst = np.zeros(n), np.zeros(n), np.zeros(n)
        self.above, self.tolerance = np.zeros(n), tolerance
        self.histogram = np.zeros((n, BINS), dtype=np.int32)
        self.reference = reference
        self.allowed = max(1, round(WORST * reference))

    def add(self, size: Array) -> None:
        """Count |d| of s machines, (N, s)."""
        n, s = size.shape
        self.count += s
        self.sum += size.sum(axis=1)
        self.squares += np.einsum("ns,ns->n", size, size)
        self.above += (size > self.tolerance).sum(axis=1)
        for rows in blocks(n, _POSES_A_BLOCK):
            width = self.width[rows, None]
            index = np.minimum(size[rows] / width, BINS - 1).astype(np.int64)
            index += BINS * np.arange(len(index))[:, None]
            found = np.bincount(index.ravel(), minlength=BINS * len(index))
            self.histogram[rows] += found.reshape(-1, BINS).astype(np.int32)
        by_machine = np.ascontiguousarray(size.T)
        place = self.reference - self.allowed
        limit = np.partition(by_machine[:, : self.reference], place, axis=1)[:, place]
        self.worst += (by_machine >= limit[:, None]).sum(axis=0)

    def count_only(self, G: Array, theta: Array) -> None:
        """Count |G theta| of s machines without asking for their worst poses."""
        found = count_lengths(G, theta, self.width, self.tolerance)
        self.count += theta.shape[1]
        self.sum += found.sum
        self.squares += found.squares
        self.above += found.above
        self.histogram += found.histogram

    def result(self, recurrence_known: bool) -> Volumetric:
        """Statistics of all that was counted."""
        s = self.count
        mean = self.sum / s
        sd = np.sqrt(np.maximum(self.squares / s - mean**2, 0.0) * s / (s - 1))
        below = np.cumsum(self.histogram, axis=1, dtype=float) / s
        quantile, spread = [], []
        for level in QUANTILES:
            # a quantile is as unsure as the count below it: binomial, read back over the histogram
            half = np.sqrt(level * (1.0 - level) / s)
            low, middle, high = (
                self._quantile(below, np.clip(p, 0.5 / s, 1.0 - 0.5 / s))
                for p in (level - half, level, level + half)
            )
            quantile.append(middle)
            spread.append(0.5 * (high - low))
        recurrence = self.worst / s if recurrence_known else np.full(len(mean), np.nan)
        exceedance = self.above / s
        return Volumetric(
            draws=s,
            mean=mean,
            sd=sd,
            levels=QUANTILES,
            quantile=np.stack(quantile),
            recurrence=recurrence,
            mean_u=sd / np.sqrt(s),
            quantile_u=np.stack(spread),
            recurrence_u=np.sqrt(recurrence * (1.0 - recurrence) / s),
            tolerance=self.tolerance,
            exceedance=exceedance,
            exceedance_u=np.sqrt(exceedance * (1.0 - exceedance) / s),
        )

    def _quantile(self, below: Array, level: float) -> Array:
        """Quantile of every row, linear within its bin, (N,)."""
        k = np.argmax(below >= level - 1e-12, axis=1)
        rows = np.arange(len(k))
        before = np.where(k > 0, below[rows, np.maximum(k - 1, 0)], 0.0)
        inside = below[rows, k] - before
        share = (level - before) / np.where(inside > 0.0, inside, 1.0)
        return (k + np.clip(share, 0.0, 1.0)) * self.width


@dataclass(frozen=True, eq=False)
class ExactCheck:
    """How far first order is from the exact product, on some machines and poses.

    Attributes:
        machines: Number of machines looked at.
        poses: Number of poses looked at.
        rms: Root mean square of the difference between the deviation vectors, mm.
        worst: Largest difference, mm.
        rms_deviation: Root mean square of the deviations themselves, mm.
    """

    machines: int
    poses: int
    rms: float
    worst: float
    rms_deviation: float


def exact_check(
    population: Population,
    q: Array,
    length: Array | float,
    machines: int,
    rng: np.random.Generator,
) -> ExactCheck:
    """Compare first-order deviations of a few random machines with the exact product.

    Args:
        population: What to draw from.
        q: Readings of the poses to look at, shape (N, A).
        length: Tool length, mm.
        machines: Number of random machines.
        rng: Source of the random numbers.
    """
    model = population.model
    touches = at_poses(population.chain, q, length)
    G = model.tip_columns(touches)
    off, all_of_it = [], []
    for theta in coefficients(population, draw(population, machines, rng)):
        exact = model.tip_deviation(touches, theta)
        off.append(np.linalg.norm(exact - G @ theta, axis=1))
        all_of_it.append(np.linalg.norm(exact, axis=1))
    difference, size = np.array(off), np.array(all_of_it)
    return ExactCheck(
        machines=machines,
        poses=len(q),
        rms=float(np.sqrt(np.mean(difference**2))),
        worst=float(difference.max()),
        rms_deviation=float(np.sqrt(np.mean(size**2))),
    )
