"""Tails of the F distribution: how probable a drop of a squared residual is by chance.

`scipy.special.fdtrc` rather than `scipy.stats.f.sf`: importing `scipy.stats` takes two seconds.
"""

import numpy as np
from scipy.special import fdtrc

from matstd.twin.frames import Array

SMALLEST = 1e-300  # probabilities are not reported smaller than this


def f_tail(ratio: Array | float, k: Array | float, dof: Array | float) -> Array:
    """Probability of a ratio of mean squares at least as large.

    Args:
        ratio: Mean square of k values over that of the others.
        k: Degrees of freedom above the line; need not be whole.
    """
    p = fdtrc(np.maximum(k, 1e-9), np.maximum(dof, 1.0), np.maximum(ratio, 0.0))
    return np.maximum(p, SMALLEST)


def f_probability(
    drop: Array | float, k: Array | float, rest: Array | float, dof: Array | float
) -> Array:
    """Probability of an F statistic at least as large: drop over k against rest over dof.

    Args:
        drop: Fall of the squared residual by k further columns.
        rest: Squared residual with them.
        dof: Degrees of freedom with them.
    """
    mean_square = np.maximum(rest, 1e-300) / np.maximum(dof, 1.0)
    return f_tail(drop / np.maximum(k, 1e-9) / mean_square, k, dof)
