"""Points that fill a cube evenly, for readings over the travels of a machine and grids over faces.

The quasi-Monte Carlo module of scipy is not used: its import takes two seconds, longer than most
commands that need a few hundred poses, and its sequences are even only at powers of two.
"""

from typing import Any

import numpy as np
from numpy.typing import NDArray

from matstd.twin.frames import Array, IntArray


def even_points(count: int, dimensions: int, start: int = 0) -> Array:
    """Points of low discrepancy in the unit cube behind the first `start`, (count, dimensions).

    Point i is the fractional part of ``0.5 + i alpha``, alpha the powers of 1/g, with g the root of
    ``g^(d+1) = g + 1`` in d dimensions (M. Roberts, The unreasonable effectiveness of quasirandom
    sequences, 2018).
    """
    g = 1.5
    for _ in range(60):  # the fixed-point form contracts by 1 / (d + 1) and more
        g = (1.0 + g) ** (1.0 / (dimensions + 1))
    alpha = g ** -np.arange(1.0, dimensions + 1.0)
    return np.mod(0.5 + np.outer(np.arange(start + 1, start + count + 1), alpha), 1.0)


def spread_rows(count: int, most: int) -> IntArray:
    """Numbers of at most so many of `count` rows, evenly spread, the first and last among them."""
    return np.unique(np.linspace(0, count - 1, min(count, most)).astype(np.int64))


def grid_points(*axes: NDArray[Any]) -> Array:
    """All points of a grid with these values along its axes, the last fastest, (points, axes)."""
    return np.stack(np.meshgrid(*axes, indexing="ij"), axis=-1).reshape(-1, len(axes))


def latin_points(low: Array, high: Array, count: int, rng: np.random.Generator) -> Array:
    """A Latin hypercube: each of `count` strata of every variable once, (count, len(low))."""
    strata = np.stack([rng.permutation(count) for _ in low], axis=-1)
    return low + (high - low) * (strata + rng.random(strata.shape)) / count
