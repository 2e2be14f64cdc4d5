"""Total-effect indices of the length |d| at many poses, interactions included.

Jansen's estimator, ``T_p = mean (f(a) - f(a with p from b))^2 / (2 Var f)``. The deviation is
linear in the errors, so the change of one error is a rank-one update of d: six operations in place
of a new sum over all errors. Compiled, the changes are taken in single precision, a thousandth of
the sampling error of a thousand machines.
"""

from collections.abc import Callable
from concurrent.futures import ThreadPoolExecutor
from functools import lru_cache
from os import cpu_count
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from matstd.sensitivity.first_order import jacobian_by_parameter
from matstd.sensitivity.montecarlo import seed_words
from matstd.sensitivity.population import Population, coefficients, draw, shape_columns
from matstd.twin.compute import blocks, compiled_loop, one_blas_thread
from matstd.twin.errors import DesignError, ShapeMismatch
from matstd.twin.frames import Array

MACHINES = 1024
_POSES_A_BLOCK = 32

Kernel = Callable[[NDArray[Any], NDArray[Any], NDArray[Any], Array], None]
Values = Callable[[slice], tuple[Array, Array]]


class TotalEffects(NamedTuple):
    """Total-effect indices of |d|."""

    total: Array  # index of every error at every pose, (P, N); zero where |d| does not vary
    u: Array  # its standard error by sampling, (P, N)
    machines: int  # pairs of random machines
    seed: str = ""  # where they came from; empty where they were given


def total_effects(J: Array, a: Array, b: Array, compiled: bool = True) -> TotalEffects:
    """Total-effect index of every error on |d| at every pose, for errors of known values.

    Args:
        J: Deviation per unit of every error, (P, 3, N), as `jacobian_by_parameter` gives it.
        a: Values of the errors of S random machines, (P, S), mm and rad.
        b: The same of S other machines, (P, S).
        compiled: Use numba where it is installed; numpy is the reference.

    Raises:
        ShapeMismatch: Errors, machines and columns do not go together.

    Reference:
        Jansen, Computer Physics Communications 117 (1999) 35; Saltelli et al. (2010), table 2 (f).
    """
    if a.shape != b.shape or len(a) != len(J):
        raise ShapeMismatch(
            f"errors of shapes {a.shape} and {b.shape} for {len(J)} columns, expected (P, S) twice"
        )
    step = (b - a)[None]
    return _estimated(J, lambda _: (a[None], step), a.shape[1], compiled)


def norm_shares(
    population: Population,
    q: Array,
    length: Array | float,
    rng: np.random.Generator,
    machines: int = MACHINES,
    compiled: bool = True,
) -> TotalEffects:
    """Total-effect index of every error of random machines on |d| at every pose.

    An error changes as a whole: amplitude, sign, shape, periods and phase.

    Raises:
        DesignError: The errors depend on each other, so changing one alone is meaningless.
    """
    if population.dependence is not None:
        raise DesignError("total effects want independent errors; these are correlated")
    seed = seed_words(rng)
    J = jacobian_by_parameter(population.chain, q, length)
    first, second = rng.spawn(2)  # of the machines, and of those that lend them single errors
    one, two = (coefficients(population, draw(population, machines, r)).T for r in (first, second))
    shapes = shape_columns(population, q)

    def values(rows: slice) -> tuple[Array, Array]:
        a = np.empty((rows.stop - rows.start, len(J), machines))
        step, start = np.empty_like(a), 0
        for p, columns in enumerate(shapes):
            mine = slice(start, start + columns.shape[1])
            a[:, p] = columns[rows] @ one[mine]
            step[:, p] = columns[rows] @ two[mine] - a[:, p]
            start = mine.stop
        return a, step

    return _estimated(J, values, machines, compiled)._replace(seed=seed)


def _estimated(J: Array, values: Values, machines: int, compiled: bool) -> TotalEffects:
    """Jansen's estimator, from errors of some poses and their changes, (n or 1, P, S) each."""
    kernel: Kernel = (_compiled() if compiled else None) or _squares
    kind = np.float64 if kernel is _squares else np.float32
    total, u = np.zeros((len(J), J.shape[2])), np.zeros((len(J), J.shape[2]))

    def work(rows: slice) -> None:
        columns = np.ascontiguousarray(np.moveaxis(J[:, :, rows], -1, 0))  # (n, P, 3)
        a, step = values(rows)
        d = np.swapaxes(columns, 1, 2) @ a  # (n, 3, S)
        sums = np.zeros((2, *columns.shape[:2]))
        kernel(
            columns.astype(kind),
            np.ascontiguousarray(d, dtype=kind),
            np.ascontiguousarray(step, dtype=kind),
            sums,
        )
        size = np.linalg.norm(d, axis=1)
        away = (size - size.mean(axis=1, keepdims=True)) ** 2
        variance, varies = away.mean(axis=1), away.var(axis=1)
        mean, square = sums.swapaxes(1, 2) / machines
        np.divide(0.5 * mean, variance, out=total[:, rows], where=variance > 0.0)
        # a quotient: numerator and variance both come from S machines, taken as independent
        spread = np.maximum(0.25 * (square - mean**2) + total[:, rows] ** 2 * varies, 0.0)
        np.divide(np.sqrt(spread / machines), variance, out=u[:, rows], where=variance > 0.0)

    with one_blas_thread(), ThreadPoolExecutor(cpu_count() or 1) as pool:
        for done in pool.map(work, blocks(J.shape[2], _POSES_A_BLOCK)):
            assert done is None
    return TotalEffects(total, u, machines)


def _squares(columns: Array, d: Array, step: Array, sums: Array) -> None:
    """Sums over the machines of the second and fourth power of changes of |d|, (2, n, P)."""
    for n in range(len(columns)):
        size = np.linalg.norm(d[n], axis=0)
        change = step[n if len(step) > 1 else 0]
        for p in range(len(change)):
            moved = d[n] + columns[n, p][:, None] * change[p]
            square = (np.sqrt(np.einsum("is,is->s", moved, moved)) - size) ** 2
            sums[0, n, p], sums[1, n, p] = square.sum(), square @ square


@lru_cache(maxsize=1)
def _compiled() -> Kernel | None:
    """The same compiled, or None without numba."""
    return compiled_loop(_squares_in_loops, fastmath=True)


def _squares_in_loops(columns, d, step, sums):  # type: ignore[no-untyped-def]
    """What `_squares` does, in single precision and machine by machine."""
    draws = d.shape[2]
    for n in range(columns.shape[0]):
        dx, dy, dz = d[n, 0], d[n, 1], d[n, 2]
        size = np.sqrt(dx * dx + dy * dy + dz * dz)
        each = step[n if step.shape[0] > 1 else 0]
        for p in range(each.shape[0]):
            jx, jy, jz = columns[n, p, 0], columns[n, p, 1], columns[n, p, 2]
            change = each[p]
            total, fourth = np.float32(0.0), np.float32(0.0)
            for s in range(draws):
                x = dx[s] + jx * change[s]
                y = dy[s] + jy * change[s]
                z = dz[s] + jz * change[s]
                off = np.sqrt(x * x + y * y + z * z) - size[s]
                square = off * off
                total += square
                fourth += square * square
            sums[0, n, p] = total
            sums[1, n, p] = fourth
