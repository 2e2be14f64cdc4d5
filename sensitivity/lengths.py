"""Lengths |d| of many machines' deviations at many poses: one product of matrices, counted at once.

The product is cut into blocks of poses that stay in the cache; of each only sums and a histogram
are kept. One BLAS thread each, and own threads over the blocks: idle BLAS threads would spin. With
numba installed (the extra `fast`) the counting is compiled; numpy is the reference.
"""

from collections.abc import Callable
from concurrent.futures import ThreadPoolExecutor
from contextlib import AbstractContextManager, nullcontext
from dataclasses import dataclass
from functools import lru_cache
from os import cpu_count

import numpy as np
from numpy.typing import NDArray

from sensitivity.blocks import blocks
from twin.frames import Array

BINS = 2048
_POSES_A_BLOCK = 32
_DRAWS_A_BLOCK = 2048

Kernel = Callable[[Array, Array, Array, Array, Array, NDArray[np.int32]], None]


@dataclass(frozen=True, eq=False)
class Lengths:
    """What is kept of the lengths of S machines at N poses.

    Attributes:
        sum: Shape (N,), mm.
        squares: Sum of squares, (N,), mm^2.
        above: Machines above the tolerance, (N,).
        histogram: Shape (N, BINS); the last bin holds whatever is longer.
    """

    sum: Array
    squares: Array
    above: Array
    histogram: NDArray[np.int32]


def count_lengths(
    G: Array,
    theta: Array,
    width: Array,
    tolerance: float = np.inf,
    compiled: bool = True,
    threads: int | None = None,
) -> Lengths:
    """Count the lengths ``|G_n theta_s|`` of every machine at every pose.

    The result does not depend on the number of threads.

    Args:
        G: Deviation of the tip per unit of every parameter, (N, 3, K), mm.
        theta: Machines, (K, S).
        width: Of a bin of the histogram at every pose, (N,), mm.
        tolerance: Longer ones are counted, mm.
        compiled: Count with numba where it is installed.
        threads: Number of threads; None for one a core.
    """
    n, draws = len(G), theta.shape[1]
    found = Lengths(np.zeros(n), np.zeros(n), np.zeros(n), np.zeros((n, BINS), dtype=np.int32))
    kernel = (compiled_kernel() if compiled else None) or _count
    lots = [np.ascontiguousarray(theta[:, lot]) for lot in blocks(draws, _DRAWS_A_BLOCK)]
    limit = np.full(n, tolerance)

    def work(rows: slice) -> None:
        columns = G[rows].reshape(-1, G.shape[2])
        mine = found.histogram[rows]
        sums = np.stack([found.sum[rows], found.squares[rows], found.above[rows]])
        for lot in lots:
            d = (columns @ lot).reshape(-1, 3, lot.shape[1])
            kernel(d, width[rows], limit[rows], np.empty(lot.shape[1]), sums, mine)
        found.sum[rows], found.squares[rows], found.above[rows] = sums

    with one_blas_thread(), ThreadPoolExecutor(threads or cpu_count() or 1) as pool:
        for done in pool.map(work, blocks(n, _POSES_A_BLOCK)):
            assert done is None
    return found


def _count(
    d: Array, width: Array, limit: Array, room: Array, sums: Array, histogram: NDArray[np.int32]
) -> None:
    """Count a block in numpy: d (n, 3, s); sums (3, n) and histogram (n, BINS) are added to."""
    size = np.sqrt(np.einsum("nis,nis->ns", d, d))
    sums[0] += size.sum(axis=1)
    sums[1] += np.einsum("ns,ns->n", size, size)
    sums[2] += (size > limit[:, None]).sum(axis=1)
    size *= (1.0 / width)[:, None]
    index = np.minimum(size, BINS - 1, out=size).astype(np.int64)
    index += BINS * np.arange(len(index))[:, None]
    counted = np.bincount(index.ravel(), minlength=histogram.size)
    histogram += counted.reshape(histogram.shape).astype(np.int32)


@lru_cache(maxsize=1)
def compiled_kernel() -> Kernel | None:
    """The same compiled, or None without numba."""
    try:
        from numba import njit
    except ImportError:
        return None

    def count(d, width, limit, room, sums, histogram):  # type: ignore[no-untyped-def]
        draws = d.shape[2]
        for n in range(d.shape[0]):
            x, y, z, per_bin = d[n, 0], d[n, 1], d[n, 2], 1.0 / width[n]
            total, square = 0.0, 0.0
            for s in range(draws):
                q = x[s] * x[s] + y[s] * y[s] + z[s] * z[s]
                square += q
                size = np.sqrt(q)
                total += size
                room[s] = size
            above, tolerance, row = 0, limit[n], histogram[n]
            for s in range(draws):
                above += room[s] > tolerance
                row[int(min(room[s] * per_bin, BINS - 1.0))] += 1
            sums[0, n] += total
            sums[1, n] += square
            sums[2, n] += above

    kernel: Kernel = njit(nogil=True, fastmath={"reassoc", "contract", "nsz"})(count)
    return kernel


def one_blas_thread() -> AbstractContextManager[object]:
    """One thread for every product of matrices within, where threadpoolctl can see to it."""
    try:
        from threadpoolctl import threadpool_limits
    except ImportError:
        return nullcontext()
    limits: AbstractContextManager[object] = threadpool_limits(1, user_api="blas")
    return limits
