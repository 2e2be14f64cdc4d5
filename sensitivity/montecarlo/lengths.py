"""Lengths |d| of many machines' deviations at many poses: one product of matrices, counted at once.

The product is cut into blocks of poses and machines that stay in the cache; of each only sums and a
histogram are kept. Own threads run over the blocks, with one BLAS thread each: idle BLAS threads
would spin. With numba installed (the extra `fast`) the counting is compiled; numpy is the
reference.
"""

from collections.abc import Callable
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass
from functools import lru_cache
from os import cpu_count
from typing import Any

import numpy as np
from numpy.typing import NDArray

from matstd.twin.compute import blocks, compiled_loop, one_blas_thread
from matstd.twin.frames import Array, IntArray

BINS = 2048  # a quantile is then read to 0.05 % of the longest length
_POSES_A_BLOCK = 256  # lengths of a block stay in a core's second cache
_DRAWS_A_BLOCK = 512  # with 256 poses the packing of both factors is small beside the product
_LENGTHS_HELD = 2**25  # lengths held at once for the worst poses: 128 MiB
_MACHINES_A_PART = 64  # whose worst poses one thread looks for

Sizes = NDArray[np.float32]  # lengths kept for the worst poses, (N, S); no column where none are
Count = Callable[..., None]


@dataclass(frozen=True, eq=False)
class Lengths:
    """What is kept of the lengths of S machines at N poses."""

    draws: int  # S
    sum: Array  # shape (N,), mm
    squares: Array  # sum of squares, (N,), mm^2
    above: Array  # machines above the tolerance, (N,)
    histogram: NDArray[Any]  # shape (N, BINS); the last bin holds whatever is longer
    # machines for which the pose is among the worst ones, (N,); zero if not asked for
    worst: IntArray


def count_lengths(
    G: Array,
    theta: Array,
    width: Array,
    tolerance: float = np.inf,
    worst: tuple[int, int] = (0, 0),
    use_compiled: bool = True,
    threads: int | None = None,
) -> Lengths:
    """Count the lengths ``|G_n theta_s|`` of every machine at every pose.

    The result does not depend on the number of threads.

    Args:
        G: Deviation of the tip per unit of every parameter, (N, 3, K), mm.
        theta: Machines, (K, S).
        width: Width of a bin of the histogram at every pose, (N,), mm.
        tolerance: Longer ones are counted, mm.
        worst: Number of first poses among which the worst are searched, and how many count as
            worst; lengths are then held in single precision, in blocks of machines.
        threads: Number of threads; None for one a core.
    """
    n, draws = len(G), theta.shape[1]
    # up to 65 535 machines two bytes a bin suffice: the histogram is the largest array here
    counter = np.uint16 if draws <= np.iinfo(np.uint16).max else np.int32
    found = Lengths(
        draws=draws,
        sum=np.zeros(n),
        squares=np.zeros(n),
        above=np.zeros(n),
        histogram=np.zeros((n, BINS), dtype=counter),
        worst=np.zeros(n, dtype=np.int64),
    )
    count = (compiled_count() if use_compiled else None) or _count
    lot = _DRAWS_A_BLOCK * max(1, _LENGTHS_HELD // n // _DRAWS_A_BLOCK) if worst[0] else draws
    # our threads fill the cores; those of BLAS on top would only wait for each other
    with one_blas_thread(), ThreadPoolExecutor(threads or cpu_count() or 1) as pool:
        for machines in blocks(draws, lot):
            part = theta[:, machines]
            size = np.empty((n, part.shape[1] if worst[0] else 0), dtype=np.float32)
            _count_all(G, part, width, tolerance, found, size, count, pool)
            parts = (size[:, some] for some in blocks(size.shape[1], _MACHINES_A_PART))
            for among in pool.map(lambda some: _among_worst(some, *worst), parts):
                found.worst[:] += among
    return found


def _count_all(
    G: Array,
    theta: Array,
    width: Array,
    tolerance: float,
    found: Lengths,
    size: Sizes,
    count: Count,
    pool: ThreadPoolExecutor,
) -> None:
    """Add some machines at all poses to what was found, and keep their lengths if there is room."""
    lots = [(np.ascontiguousarray(theta[:, s]), s) for s in blocks(theta.shape[1], _DRAWS_A_BLOCK)]

    def work(rows: slice) -> None:
        columns = G[rows].reshape(-1, G.shape[2])
        mine = found.histogram[rows]
        sums = np.stack([found.sum[rows], found.squares[rows], found.above[rows]])
        room = np.empty(len(columns) * _DRAWS_A_BLOCK)  # fresh pages for every lot cost a tenth
        line, index = np.empty(_DRAWS_A_BLOCK, np.float32), np.empty(_DRAWS_A_BLOCK, np.uint16)
        for lot, some in lots:
            product = room[: len(columns) * lot.shape[1]].reshape(len(columns), -1)
            d = np.matmul(columns, lot, out=product).reshape(-1, 3, lot.shape[1])
            count(d, width[rows], tolerance, line, index, sums, mine, size[rows, some])
        found.sum[rows], found.squares[rows], found.above[rows] = sums

    for done in pool.map(work, blocks(len(G), _POSES_A_BLOCK)):
        assert done is None


def _among_worst(size: Sizes, reference: int, allowed: int) -> IntArray:
    """Machines of size (N, m) for which each pose is among the worst `allowed`, (N,).

    The limit of every machine is the largest length that so many of the first `reference` poses
    reach.
    """
    by_machine = np.ascontiguousarray(size.T)
    place = reference - allowed
    limit = np.partition(by_machine[:, :reference], place, axis=1)[:, place]
    return np.asarray((by_machine >= limit[:, None]).sum(axis=0))


def _count(
    d: Array,
    width: Array,
    limit: float,
    line: NDArray[np.float32],
    index: NDArray[np.uint16],
    sums: Array,
    histogram: NDArray[Any],
    size: Sizes,
) -> None:
    """Count a block in numpy: d (n, 3, s); sums (3, n) and histogram (n, BINS) are added to."""
    length = np.sqrt(np.einsum("nis,nis->ns", d, d))
    sums[0] += length.sum(axis=1)
    sums[1] += np.einsum("ns,ns->n", length, length)
    sums[2] += (length > limit).sum(axis=1)
    if size.shape[1]:
        size[:] = length
    length *= (1.0 / width)[:, None]
    bins = np.minimum(length, BINS - 1, out=length).astype(np.int64)
    bins += BINS * np.arange(len(bins))[:, None]
    counted = np.bincount(bins.ravel(), minlength=histogram.size)
    histogram += counted.reshape(histogram.shape).astype(histogram.dtype)


@lru_cache(maxsize=1)
def compiled_count() -> Count | None:
    """What `_count` does, compiled; None without numba."""
    return compiled_loop(_count_in_loops, fastmath={"reassoc", "contract", "nsz"})


def _count_in_loops(d, width, limit, line, index, sums, histogram, size):  # type: ignore[no-untyped-def]
    """Count lengths of deviations d (n, 3, s); add to sums (3, n) and histogram (n, bins).

    The square and its sum are double; root, mean and bin are single: a bin is wider by far. Indices
    without a sign spare a comparison each. Lengths are kept in size (n, s) if it has room.
    """
    draws, top = d.shape[2], np.float32(histogram.shape[1] - 1)
    for n in range(d.shape[0]):
        x, y, z, row = d[n, 0], d[n, 1], d[n, 2], histogram[n]
        per_bin, tolerance = np.float32(1.0 / width[n]), limit * limit
        total, square, above = np.float32(0.0), 0.0, 0
        for s in range(draws):
            q = x[s] * x[s] + y[s] * y[s] + z[s] * z[s]
            square += q
            above += q > tolerance
            length = np.sqrt(np.float32(q))
            total += length
            line[s] = length
            index[s] = np.uint16(np.int32(min(length * per_bin, top)))
        for s in range(draws):
            row[index[s]] += 1
        if size.shape[1]:
            size[n, :] = line[:draws]
        sums[0, n] += total
        sums[1, n] += square
        sums[2, n] += above
