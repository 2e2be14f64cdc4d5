"""Statistics of the volumetric error over random machines, from counted lengths."""

from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from matstd.sensitivity.montecarlo.lengths import BINS, Lengths
from matstd.sensitivity.montecarlo.stability import Stability
from matstd.twin.compute import blocks
from matstd.twin.frames import Array

QUANTILES = (0.5, 0.95, 0.99)
_ROWS = 1000  # poses whose histograms are summed at once


@dataclass(frozen=True, eq=False)
class Volumetric:
    """Volumetric error |d| of S random machines at N poses, first order, mm."""

    draws: int  # S
    seed: str  # where the random numbers came from: the seed, and the path of its children
    mean: Array  # shape (N,)
    sd: Array  # shape (N,)
    levels: tuple[float, ...]  # probabilities of the quantiles, (Q,)
    quantile: Array  # shape (Q, N)
    recurrence: Array  # share of the machines for which the pose is among the worst 5 %, (N,)
    mean_u: Array  # standard error of the mean by sampling, (N,)
    quantile_u: Array  # standard error of the quantiles by sampling, (Q, N)
    recurrence_u: Array  # standard error of the recurrence by sampling, (N,)
    tolerance: float  # volumetric error that users allow, mm; infinite where they said nothing
    exceedance: Array  # share of the machines beyond the tolerance, (N,)
    exceedance_u: Array  # standard error of the exceedance by sampling, (N,)
    # whether the digits that were asked for are stable; None if none were
    stability: Stability | None

    def __getitem__(self, rows: slice) -> "Volumetric":
        """The statistics of some poses."""
        arrays = ((n, v) for n, v in vars(self).items() if isinstance(v, np.ndarray))
        cut: dict[str, Any] = {name: values[..., rows] for name, values in arrays}
        return replace(self, **cut)

    @property
    def p95(self) -> Array:
        """95 % of the machines stay below this, (N,), mm."""
        return self.quantile[self.levels.index(0.95)]

    @property
    def p95_u(self) -> Array:
        """Standard error of `p95`, (N,), mm."""
        return self.quantile_u[self.levels.index(0.95)]

    @property
    def achieved(self) -> float:
        """Twice the largest standard error of mean and 95 % quantile at any pose, mm."""
        return 2.0 * float(max(self.mean_u.max(), self.p95_u.max()))


class Tally:
    """Sums, histogram and worst poses of |d|, batch by batch, for N poses."""

    def __init__(self, width: Array, tolerance: float) -> None:
        n = len(width)
        self.width, self.tolerance = width, tolerance
        self.count = 0
        self.sum, self.squares, self.above = np.zeros(n), np.zeros(n), np.zeros(n)
        self.worst = np.zeros(n, dtype=np.int64)
        self.histogram = np.zeros((n, BINS), dtype=np.int32)

    def add(self, found: Lengths) -> None:
        """Add what was counted of some machines."""
        self.count += found.draws
        self.sum += found.sum
        self.squares += found.squares
        self.above += found.above
        self.worst += found.worst
        self.histogram += found.histogram

    def result(
        self, seed: str, recurrence_known: bool, stability: Stability | None = None
    ) -> Volumetric:
        """Statistics of all that was counted."""
        s = self.count
        mean, sd = moments(s, self.sum, self.squares)
        # a quantile is as unsure as the count below it: binomial, read back over the histogram
        level = np.array(QUANTILES)
        half = np.sqrt(level * (1.0 - level) / s)
        levels = np.clip([level - half, level, level + half], 0.5 / s, 1.0 - 0.5 / s)
        low, middle, high = np.split(quantiles(self.histogram, self.width, levels.ravel()), 3)
        recurrence = self.worst / s if recurrence_known else np.full(len(mean), np.nan)
        exceedance = self.above / s
        return Volumetric(
            draws=s,
            seed=seed,
            mean=mean,
            sd=sd,
            levels=QUANTILES,
            quantile=middle,
            recurrence=recurrence,
            mean_u=sd / np.sqrt(s),
            quantile_u=0.5 * (high - low),
            recurrence_u=np.sqrt(recurrence * (1.0 - recurrence) / s),
            tolerance=self.tolerance,
            exceedance=exceedance,
            exceedance_u=np.sqrt(exceedance * (1.0 - exceedance) / s),
            stability=stability,
        )


def moments(count: int, total: Array, squares: Array) -> tuple[Array, Array]:
    """Mean and standard deviation from sums, (N,) each."""
    mean = total / count
    spread = np.maximum(squares / count - mean**2, 0.0)
    return mean, np.sqrt(spread * count / (count - 1))


def quantiles(
    histogram: NDArray[np.integer], width: Array, levels: Array | tuple[float, ...]
) -> Array:
    """Quantiles (Q, N), mm, of counts from zero up, (N, BINS), in bins of a width (N,), mm.

    They are linear within their bin.
    """
    out = np.empty((len(levels), len(histogram)))
    for rows in blocks(len(histogram), _ROWS):
        below = np.cumsum(histogram[rows], axis=1, dtype=np.int64)
        total, each = below[:, -1], np.arange(len(below))
        for i, level in enumerate(levels):
            wanted = level * total
            k = np.argmax(below >= (wanted - 1e-9 * total)[:, None], axis=1)
            before = np.where(k > 0, below[each, np.maximum(k - 1, 0)], 0)
            inside = below[each, k] - before
            share = (wanted - before) / np.where(inside > 0, inside, 1)
            out[i, rows] = (k + np.clip(share, 0.0, 1.0)) * width[rows]
    return out
