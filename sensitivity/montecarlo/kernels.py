"""Compiled loops of the Monte Carlo (the extra `fast`): counting lengths, finding worst poses.

`matstd.sensitivity.montecarlo.lengths` has both in numpy, which is the reference; nothing here is
needed to run.
"""

from collections.abc import Callable
from functools import lru_cache
from typing import NamedTuple

import numpy as np

from matstd.twin.compute import compiled_loop

MACHINES_A_BLOCK = 64
"""Machines whose lengths lie side by side: a pass over the poses takes them all at once."""


class Kernels(NamedTuple):
    """The compiled functions."""

    tally: Callable[..., None]  # lengths of a block of deviations into sums and histogram
    worst: Callable[..., None]  # machines for which a pose is among the worst ones


@lru_cache(maxsize=1)
def compiled() -> Kernels | None:
    """The kernels, or None without numba."""
    relaxed = {"reassoc", "contract", "nsz"}
    tally, worst = (compiled_loop(f, fastmath=relaxed) for f in (_count, _worst))
    return None if tally is None or worst is None else Kernels(tally, worst)


def _count(d, width, limit, line, index, sums, histogram, size):  # type: ignore[no-untyped-def]
    """Count lengths of deviations d (n, 3, s); add to sums (3, n) and histogram (n, bins).

    The square and its sum are double; root, mean and bin are single: a bin is wider by far. Indices
    without a sign spare a comparison each. Lengths are kept in size (blocks, n, 64) if it has any.
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
        for b in range(size.shape[0]):
            part = line[b * 64 : min(b * 64 + 64, draws)]
            size[b, n, : part.shape[0]] = part
        sums[0, n] += total
        sums[1, n] += square
        sums[2, n] += above


def _worst(size, reference, allowed, worst):  # type: ignore[no-untyped-def]  # noqa: C901
    """Add the machines of size (n, m) for which a pose is among the worst `allowed` to worst (n,).

    The limit of every machine is the largest length that so many of the first `reference` poses
    reach. It is found by false position with the weights of the Illinois rule on the number of
    poses beyond a value, all machines in one pass; poses equally bad end it by bisection. One
    function, because a compiled one sees no others.
    """
    m = size.shape[1]
    low, high = np.zeros(m, np.float32), np.zeros(m, np.float32)
    for n in range(reference):
        row = size[n]
        for j in range(m):
            high[j] = max(high[j], row[j])
    for j in range(m):  # just beyond the largest, so that nothing reaches it
        high[j] = high[j] * np.float32(1.000001) + np.float32(1e-30)
    n_low, n_high = np.full(m, reference, np.int32), np.zeros(m, np.int32)
    weight_low, weight_high = np.ones(m, np.float32), np.ones(m, np.float32)
    tried, reached = np.empty(m, np.float32), np.empty(m, np.int32)
    closed = np.zeros(m, np.bool_)
    opened = m
    while opened:
        opened = 0
        for j in range(m):
            if closed[j]:
                continue
            over = max((n_low[j] - allowed) * weight_low[j], np.float32(0.25))
            under = max((allowed - n_high[j]) * weight_high[j], np.float32(0.25))
            x = low[j] + (high[j] - low[j]) * np.float32(over / (over + under))
            if not low[j] < x < high[j]:
                x = low[j] + (high[j] - low[j]) * np.float32(0.5)
            if n_low[j] == allowed or not low[j] < x < high[j]:
                closed[j], tried[j] = True, low[j]
            else:
                tried[j] = x
                opened += 1
        if not opened:
            break
        for j in range(m):
            reached[j] = 0
        for n in range(reference):
            row = size[n]
            for j in range(m):
                reached[j] += row[j] >= tried[j]
        for j in range(m):
            if closed[j]:
                continue
            if reached[j] >= allowed:
                weight_high[j] = np.float32(0.5) * weight_high[j] if weight_low[j] == 1.0 else 1.0
                low[j], n_low[j], weight_low[j] = tried[j], reached[j], 1.0
            else:
                weight_low[j] = np.float32(0.5) * weight_low[j] if weight_high[j] == 1.0 else 1.0
                high[j], n_high[j], weight_high[j] = tried[j], reached[j], 1.0
    for j in range(m):
        high[j] = np.inf
    for n in range(reference):  # the smallest length that is among the worst
        row = size[n]
        for j in range(m):
            high[j] = min(high[j], row[j] if row[j] >= low[j] else high[j])
    for n in range(size.shape[0]):
        row, count = size[n], 0
        for j in range(m):
            count += row[j] >= high[j]
        worst[n] += count
