"""Figures as files and results hold them: significant digits, in_um, root mean squares."""

import numpy as np

from matstd.twin.frames import Array, IntArray
from matstd.twin.units import UM


def significant(value: float, digits: int = 6) -> float:
    """A number rounded to significant digits.

    Example:
        >>> significant(0.012345678), significant(1234.5678, digits=4)
        (0.0123457, 1235.0)
    """
    return float(f"{value:.{digits}g}")


def in_um(value: float, places: int = 3) -> float:
    """A length in mm as µm, rounded to decimal places, without negative zero.

    Example:
        >>> in_um(0.0123456), in_um(-1e-9)
        (12.346, 0.0)
    """
    return round(float(value) / UM, places) + 0.0


def rms(values: Array) -> float:
    """Root mean square of all values of an array."""
    return float(np.sqrt(np.mean(np.square(values))))


def rms_length(vectors: Array) -> float:
    """Root mean square of the lengths of vectors, (N, 3)."""
    return float(np.sqrt(np.mean(np.sum(np.square(vectors), axis=1))))


def rms_of_columns(values: Array) -> Array:
    """Root mean square of every column, (N, K) -> (K,)."""
    return np.sqrt(np.mean(np.square(values), axis=0))


def distinct_rows(rows: Array) -> tuple[Array, IntArray]:
    """Distinct rows (K, M) in ascending order, and the number of each row among them, (N,).

    As `numpy.unique` of rows, which sorts whole rows as records and takes five times as long.

    Example:
        >>> distinct_rows(np.array([[1.0, 2.0], [0.0, 5.0], [1.0, 2.0]]))[1].tolist()
        [1, 0, 1]
    """
    if not rows.size:  # of no column all rows are the same
        return rows[:1], np.zeros(len(rows), dtype=np.int64)
    order = np.lexsort(rows.T[::-1])
    ascending = rows[order]
    is_new = np.append(True, (ascending[1:] != ascending[:-1]).any(axis=1))
    number = np.empty(len(rows), dtype=np.int64)
    number[order] = np.cumsum(is_new) - 1
    return ascending[is_new], number
