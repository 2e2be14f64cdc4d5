"""Tensor-product B-splines over the plane: values and derivatives at many points at once."""

from dataclasses import dataclass

import numpy as np

from matstd.twin.errors import ShapeMismatch
from matstd.twin.frames import Array


def clamped_knots(low: float, high: float, count: int, degree: int) -> Array:
    """Equally spaced clamped knots for `count` poles on [low, high], shape (count + degree + 1,).

    Raises:
        ShapeMismatch: Fewer poles than degree + 1.
    """
    if count < degree + 1:
        raise ShapeMismatch(f"{count} poles cannot carry degree {degree}; at least {degree + 1}")
    inner = np.linspace(low, high, count - degree + 1)
    return np.concatenate([np.full(degree, low), inner, np.full(degree, high)])


def check_knots(knots: Array, degree: int, reach: float, what: str) -> None:
    """Reject knots that do not belong to a smooth, clamped and wide enough spline.

    Args:
        knots: Shape (poles + degree + 1,).
        reach: How far the knots must reach to both sides of zero, mm.

    Raises:
        ShapeMismatch: Names the violated condition.
    """
    if degree < 2:
        raise ShapeMismatch(f"{what}: degree {degree}, expected at least 2 for a normal that bends")
    if np.any(np.diff(knots) < 0.0):
        raise ShapeMismatch(f"{what} must ascend")
    if knots[0] != knots[degree] or knots[-1] != knots[-degree - 1]:
        raise ShapeMismatch(f"{what}: the first and the last knot must stand {degree + 1} times")
    inner, counts = np.unique(knots[degree + 1 : -degree - 1], return_counts=True)
    if np.any(counts > degree - 1) or np.any((inner == knots[0]) | (inner == knots[-1])):
        raise ShapeMismatch(f"{what}: a knot stands too often for a face without a crease")
    if min(-knots[0], knots[-1]) < reach:
        raise ShapeMismatch(
            f"{what} go from {knots[0]:g} to {knots[-1]:g} mm, expected {reach:g} mm to both sides"
        )


def greville(knots: Array, degree: int) -> Array:
    """Abscissae of the poles with which the spline reproduces ``x = u`` exactly.

    ``g_i = (t_{i+1} + ... + t_{i+k}) / k``, shape (poles,).
    """
    count = len(knots) - degree - 1
    windows = np.lib.stride_tricks.sliding_window_view(knots[1:-1], degree)[:count]
    return windows.mean(axis=1)


def basis(knots: Array, degree: int, x: Array, orders: int = 3) -> tuple[np.ndarray, Array]:
    """The degree + 1 B-splines that do not vanish at each x, with up to two derivatives.

    Cox-de Boor recursion on all x at once; the derivatives come from the two lower degrees,
    ``N'_{i,k} = k (N_{i,k-1} / (t_{i+k} - t_i) - N_{i+1,k-1} / (t_{i+k+1} - t_{i+1}))``.
    Beyond the ends the outermost polynomial is continued.

    Args:
        knots: Clamped or not, ascending, shape (poles + degree + 1,).
        degree: At least 2.
        x: Shape (N,).
        orders: 1 for the values alone, 3 for two derivatives as well.

    Returns:
        Index of the first of them, shape (N,); values and derivatives, (orders, N, degree + 1).

    Reference:
        Piegl and Tiller, The NURBS Book, algorithms A2.2 and A2.3.
    """
    count = len(knots) - degree - 1
    span = np.clip(np.searchsorted(knots, x, side="right") - 1, degree, count - 1)
    near = knots[span + np.arange(1 - degree, degree + 1)[:, None]]  # (2 degree, N)
    # points along the last axis: half the time of points along the first
    ladder = [np.ones((1, len(x)))]
    for d in range(1, degree + 1):
        left, right = near[degree - d : degree], near[degree : degree + d]
        share = ladder[-1] / (right - left)
        ladder.append(_beside((right - x) * share, (x - left) * share))
    if orders == 1:
        return span - degree, ladder[degree].T[None]
    first = _derivative(near, ladder[degree - 1])
    second = _derivative(near, _derivative(near, ladder[degree - 2]))
    return span - degree, np.stack([ladder[degree].T, first.T, second.T])


def _beside(low: Array, high: Array) -> Array:
    """Sum of what each of d splines adds to its lower and its upper neighbour, (d + 1, N)."""
    values = np.zeros((len(low) + 1, low.shape[1]))
    values[:-1] += low
    values[1:] += high
    return values


def _derivative(near: Array, lower: Array) -> Array:
    """Derivatives of degree d, (d + 1, N), from values or derivatives of degree d - 1, (d, N)."""
    d, middle = len(lower), len(near) // 2
    share = d * lower / (near[middle : middle + d] - near[middle - d : middle])
    return _beside(-share, share)


@dataclass(frozen=True, eq=False)
class Jet:
    """Height and its derivatives at N points, each of shape (N,)."""

    h: Array
    hu: Array
    hv: Array
    huu: Array
    huv: Array
    hvv: Array

    @property
    def curvature(self) -> Array:
        """Principal curvatures of the graph, (N, 2), 1/mm, largest first; positive = concave.

        Eigenvalues of ``I^-1 II`` with ``I = 1 + grad h grad h^T`` and ``II = hess h / w``,
        ``w^2 = 1 + |grad h|^2``: a ball fits where its radius is below one over the largest.
        """
        w2 = 1.0 + self.hu**2 + self.hv**2
        mean2 = (
            (1 + self.hv**2) * self.huu
            - 2 * self.hu * self.hv * self.huv
            + (1 + self.hu**2) * self.hvv
        )
        mean = mean2 / (2.0 * w2**1.5)
        gauss = (self.huu * self.hvv - self.huv**2) / w2**2
        root = np.sqrt(np.maximum(mean**2 - gauss, 0.0))
        return np.column_stack([mean + root, mean - root])

    def plus(self, other: "Jet", factor: float = 1.0) -> "Jet":
        """The jet of the sum of two height fields, the second times a factor."""
        return Jet(
            h=self.h + factor * other.h,
            hu=self.hu + factor * other.hu,
            hv=self.hv + factor * other.hv,
            huu=self.huu + factor * other.huu,
            huv=self.huv + factor * other.huv,
            hvv=self.hvv + factor * other.hvv,
        )


def jet(knots_u: Array, knots_v: Array, degree: tuple[int, int], poles: Array, uv: Array) -> Jet:
    """Height field of a tensor spline with its first and second derivatives.

    ``h(u, v) = sum_ij N_i(u) N_j(v) poles_ij``.

    Args:
        knots_u: Shape (nu + ku + 1,), mm.
        knots_v: Shape (nv + kv + 1,), mm.
        degree: (ku, kv).
        poles: Control heights, shape (nu, nv), mm.
        uv: Shape (N, 2), mm.

    Returns:
        Derivatives to the second order.
    """
    bu, bv, local = _local(knots_u, knots_v, degree, poles, uv, orders=3)
    along_u = np.swapaxes(bu, 0, 1) @ local  # (N, 3, kv + 1)
    value = {
        (a, b): np.einsum("nj,nj->n", along_u[:, a], bv[b])
        for a, b in ((0, 0), (1, 0), (0, 1), (2, 0), (1, 1), (0, 2))
    }
    return Jet(*value.values())


def height(
    knots_u: Array, knots_v: Array, degree: tuple[int, int], poles: Array, uv: Array
) -> Array:
    """Height alone, (N,), of the tensor spline of `jet`; arguments as there."""
    bu, bv, local = _local(knots_u, knots_v, degree, poles, uv, orders=1)
    along_u = np.einsum("ni,nij->nj", bu[0], local)
    return np.einsum("nj,nj->n", along_u, bv[0])


def _local(
    knots_u: Array,
    knots_v: Array,
    degree: tuple[int, int],
    poles: Array,
    uv: Array,
    orders: int,
) -> tuple[Array, Array, Array]:
    """B-splines in u and v at each point, and the poles they act on, (N, ku + 1, kv + 1)."""
    first_u, bu = basis(knots_u, degree[0], uv[:, 0], orders)
    first_v, bv = basis(knots_v, degree[1], uv[:, 1], orders)
    windows = np.lib.stride_tricks.sliding_window_view(poles, (degree[0] + 1, degree[1] + 1))
    return bu, bv, windows[first_u, first_v]
