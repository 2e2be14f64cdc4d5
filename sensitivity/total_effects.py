"""Total-effect indices of the length |d| at many poses: which error matters, interactions included.

Jansen's estimator, ``T_p = mean (f(a) - f(a with p from b))^2 / (2 Var f)``. The deviation is
linear in the errors, so the change of one error is a rank-one update of d: six operations in place
of a new sum over all errors. The errors count with the values that they have at the poses; where
they vary with the reading, give their values there. Compiled, the changes are taken in single
precision, a thousandth of the sampling error of a thousand machines.
"""

from collections.abc import Callable
from concurrent.futures import ThreadPoolExecutor
from functools import lru_cache
from os import cpu_count
from typing import Any

import numpy as np
from numpy.typing import NDArray

from sensitivity.blocks import blocks
from sensitivity.lengths import one_blas_thread
from twin.errors import ShapeMismatch
from twin.frames import Array

_POSES_A_BLOCK = 32

Kernel = Callable[[NDArray[Any], NDArray[Any], NDArray[Any], Array], None]


def total_effects(J: Array, a: Array, b: Array, compiled: bool = True) -> Array:
    """Total-effect index of every error on |d| at every pose.

    Args:
        J: Deviation per unit of every error, (P, 3, N), as `jacobian_by_parameter` gives it.
        a: Values of the errors of S random machines, (P, S), mm and rad.
        b: The same of S other machines, (P, S).
        compiled: Use numba where it is installed; numpy is the reference.

    Returns:
        Shape (P, N); zero where |d| does not vary.

    Raises:
        ShapeMismatch: Errors, machines and columns do not go together.

    Reference:
        Jansen, Computer Physics Communications 117 (1999) 35; Saltelli et al. (2010), table 2 (f).
    """
    if a.shape != b.shape or len(a) != len(J):
        raise ShapeMismatch(
            f"errors of shapes {a.shape} and {b.shape} for {len(J)} columns, expected (P, S) twice"
        )
    kernel: Kernel = (_compiled() if compiled else None) or _squares
    kind = np.float64 if kernel is _squares else np.float32
    step = np.ascontiguousarray(b - a, dtype=kind)
    out = np.zeros((len(J), J.shape[2]))

    def work(rows: slice) -> None:
        columns = np.ascontiguousarray(np.moveaxis(J[:, :, rows], -1, 0))  # (n, P, 3)
        d = np.swapaxes(columns, 1, 2) @ a  # (n, 3, S)
        sums = np.zeros(columns.shape[:2])
        kernel(columns.astype(kind), np.ascontiguousarray(d, dtype=kind), step, sums)
        variance = np.linalg.norm(d, axis=1).var(axis=1)
        half = 0.5 / a.shape[1]
        np.divide(half * sums.T, variance, out=out[:, rows], where=variance > 0.0)

    with one_blas_thread(), ThreadPoolExecutor(cpu_count() or 1) as pool:
        for done in pool.map(work, blocks(J.shape[2], _POSES_A_BLOCK)):
            assert done is None
    return out


def _squares(columns: Array, d: Array, step: Array, sums: Array) -> None:
    """Sum over the machines of squared changes of |d|, (n, P), in numpy."""
    for n in range(len(columns)):
        size = np.linalg.norm(d[n], axis=0)
        for p in range(len(step)):
            moved = d[n] + columns[n, p][:, None] * step[p]
            change = np.sqrt(np.einsum("is,is->s", moved, moved)) - size
            sums[n, p] = change @ change


@lru_cache(maxsize=1)
def _compiled() -> Kernel | None:
    """The same compiled, or None without numba."""
    try:
        from numba import njit
    except ImportError:
        return None

    def squares(columns, d, step, sums):  # type: ignore[no-untyped-def]
        draws = d.shape[2]
        for n in range(columns.shape[0]):
            dx, dy, dz = d[n, 0], d[n, 1], d[n, 2]
            size = np.sqrt(dx * dx + dy * dy + dz * dz)
            for p in range(step.shape[0]):
                jx, jy, jz = columns[n, p, 0], columns[n, p, 1], columns[n, p, 2]
                change = step[p]
                total = np.float32(0.0)
                for s in range(draws):
                    x = dx[s] + jx * change[s]
                    y = dy[s] + jy * change[s]
                    z = dz[s] + jz * change[s]
                    off = np.sqrt(x * x + y * y + z * z) - size[s]
                    total += off * off
                sums[n, p] = total

    kernel: Kernel = njit(nogil=True, error_model="numpy", fastmath=True)(squares)
    return kernel
