"""Lengths |d| of many machines' deviations at many poses: one product of matrices, counted at once.

The product is cut into blocks of poses and machines that stay in the cache; of each only sums and a
histogram are kept. Own threads run over the blocks, with one BLAS thread each: idle BLAS threads
would spin. With numba installed (the extra `fast`) the counting is compiled; numpy is the
reference.
"""

from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass
from os import cpu_count
from typing import Any

import numpy as np
from numpy.typing import NDArray

from matstd.sensitivity.montecarlo.kernels import MACHINES_A_BLOCK, Kernels, compiled
from matstd.twin.compute import blocks, one_blas_thread
from matstd.twin.frames import Array

BINS = 2048  # a quantile is then read to 0.05 % of the longest length
_POSES_A_BLOCK = 256  # lengths of a block stay in a core's second cache
_DRAWS_A_BLOCK = 512  # with 256 poses the packing of both factors is small beside the product
_KEPT = 2**25  # lengths held at once for the worst poses: 128 MiB
_FEWEST_KEPT = 512

Sizes = NDArray[np.float32]
"""Lengths kept for the worst poses, (blocks, N, 64): the machines of a block side by side."""


@dataclass(frozen=True, eq=False)
class Lengths:
    """What is kept of the lengths of S machines at N poses."""

    draws: int  # S
    sum: Array  # shape (N,), mm
    squares: Array  # sum of squares, (N,), mm^2
    above: Array  # machines above the tolerance, (N,)
    histogram: NDArray[Any]  # shape (N, BINS); the last bin holds whatever is longer
    # machines for which the pose is among the worst ones, (N,); zero if not asked for
    worst: NDArray[np.int64]


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
    kernels = (compiled() if use_compiled else None) or Kernels(_count, _worst)
    reference = worst[0]
    lot = _DRAWS_A_BLOCK * max(1, _KEPT // n // _DRAWS_A_BLOCK) if reference else draws
    # our threads fill the cores; those of BLAS on top would only wait for each other
    with one_blas_thread(), ThreadPoolExecutor(threads or cpu_count() or 1) as pool:
        for machines in blocks(draws, max(lot, _FEWEST_KEPT)):
            part = theta[:, machines]
            size = _room(n, part.shape[1] if reference else 0)
            _count_all(G, part, width, tolerance, found, size, kernels, pool)
            if reference:
                _find_worst(size, part.shape[1], worst, found.worst, kernels, pool)
    return found


def _room(n: int, draws: int) -> Sizes:
    return np.empty((-(-draws // MACHINES_A_BLOCK), n, MACHINES_A_BLOCK), dtype=np.float32)


def _count_all(
    G: Array,
    theta: Array,
    width: Array,
    tolerance: float,
    found: Lengths,
    size: Sizes,
    kernels: Kernels,
    pool: ThreadPoolExecutor,
) -> None:
    """Add some machines at all poses to what was found, and keep their lengths if there is room."""
    lots = [
        (np.ascontiguousarray(theta[:, lot]), slice(lot.start // 64, -(-lot.stop // 64)))
        for lot in blocks(theta.shape[1], _DRAWS_A_BLOCK)
    ]

    def work(rows: slice) -> None:
        columns = G[rows].reshape(-1, G.shape[2])
        mine = found.histogram[rows]
        sums = np.stack([found.sum[rows], found.squares[rows], found.above[rows]])
        room = np.empty(len(columns) * _DRAWS_A_BLOCK)  # fresh pages for every lot cost a tenth
        line, index = np.empty(_DRAWS_A_BLOCK, np.float32), np.empty(_DRAWS_A_BLOCK, np.uint16)
        for lot, kept in lots:
            product = room[: len(columns) * lot.shape[1]].reshape(len(columns), -1)
            d = np.matmul(columns, lot, out=product).reshape(-1, 3, lot.shape[1])
            kernels.tally(d, width[rows], tolerance, line, index, sums, mine, size[kept, rows])
        found.sum[rows], found.squares[rows], found.above[rows] = sums

    for done in pool.map(work, blocks(len(G), _POSES_A_BLOCK)):
        assert done is None


def _find_worst(
    size: Sizes,
    draws: int,
    worst: tuple[int, int],
    into: NDArray[np.int64],
    kernels: Kernels,
    pool: ThreadPoolExecutor,
) -> None:
    """Add the machines for which each pose is among the worst."""

    def work(block: int) -> NDArray[np.int64]:
        mine = np.zeros(size.shape[1], dtype=np.int64)
        kernels.worst(size[block][:, : draws - block * MACHINES_A_BLOCK], *worst, mine)
        return mine

    for mine in pool.map(work, range(len(size))):
        into += mine


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
    for b, lot in zip(range(len(size)), blocks(d.shape[2], MACHINES_A_BLOCK), strict=False):
        size[b, :, : lot.stop - lot.start] = length[:, lot]
    length *= (1.0 / width)[:, None]
    bins = np.minimum(length, BINS - 1, out=length).astype(np.int64)
    bins += BINS * np.arange(len(bins))[:, None]
    counted = np.bincount(bins.ravel(), minlength=histogram.size)
    histogram += counted.reshape(histogram.shape).astype(histogram.dtype)


def _worst(size: Sizes, reference: int, allowed: int, worst: NDArray[np.int64]) -> None:
    """The worst poses of some machines in numpy, size (n, m)."""
    by_machine = np.ascontiguousarray(size.T)
    place = reference - allowed
    limit = np.partition(by_machine[:, :reference], place, axis=1)[:, place]
    worst += (by_machine >= limit[:, None]).sum(axis=0)
