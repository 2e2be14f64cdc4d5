"""A factor of few columns of a covariance that many points share."""

from collections.abc import Callable

import numpy as np

from matstd.twin.frames import Array
from matstd.twin.record import IntArray


def low_rank(
    diagonal: Array,
    column: Callable[[int], Array],
    left_out: float = 1e-3,
    most: int | None = None,
) -> tuple[Array, IntArray]:
    """``F`` with ``F F^T = K`` but for a share of the trace: Cholesky with pivots.

    A smooth covariance of thousands of points has a rank of a few hundred; its columns are asked
    for only where they are used.

    Args:
        diagonal: Of K, (N,).
        column: Column of K at a point, (N,).
        left_out: Share of the trace of K that may be left out.
        most: Columns at most; None for N.

    Returns:
        Shape (N, M), and the points whose columns were used, (M,).

    Reference:
        Harbrecht, Peters, Schneider, Applied Numerical Mathematics 62 (2012) 428.
    """
    left = np.array(diagonal, dtype=np.float64)
    enough, most = left_out * left.sum(), len(left) if most is None else min(most, len(left))
    F, pivots = np.zeros((most, len(left))), []
    for m in range(most):
        pivot = int(np.argmax(left))
        if left.sum() <= enough or left[pivot] <= 0.0:
            F = F[:m]
            break
        row = (column(pivot) - F[:m, pivot] @ F[:m]) / np.sqrt(left[pivot])
        F[m] = row
        pivots.append(pivot)
        left = np.maximum(left - row**2, 0.0)
        left[pivot] = 0.0
    return F.T, np.array(pivots, dtype=np.int64)
