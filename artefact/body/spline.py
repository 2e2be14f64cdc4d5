"""B-splines and their derivatives at many points at once; the jet of a height over a plane."""

from dataclasses import dataclass
from functools import lru_cache

import numpy as np

from matstd.twin.errors import ShapeMismatch
from matstd.twin.frames import Array, IntArray


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


def powers(knots: Array, degree: int, x: Array, orders: int) -> tuple[IntArray, Array]:
    """Powers, and their derivatives, of the distance of each x from the knot below it.

    Args:
        knots: Clamped or not, ascending, shape (poles + degree + 1,).
        x: Shape (N,); beyond the ends the outermost piece is continued.
        orders: 1 for the powers alone, 3 for two derivatives as well.

    Returns:
        Piece of the knots that each x is on, (N,); powers, (orders, degree + 1, N).
    """
    count = len(knots) - degree - 1
    span = np.clip(np.searchsorted(knots, x, side="right") - 1, degree, count - 1)
    power, s = np.zeros((orders, degree + 1, len(x))), x - knots[span]
    power[0, 0] = 1.0
    for k in range(degree):
        power[0, k + 1] = power[0, k] * s
    for k in range(1, orders):
        power[k, 1:] = np.arange(1.0, degree + 1.0)[:, None] * power[k - 1, :-1]
    return span - degree, power


def pieces(knots: Array, degree: int) -> Array:
    """B-splines between any two knots as polynomials of the distance from the lower one.

    Cox-de Boor recursion on coefficients, (poles - degree, degree + 1, degree + 1): for every piece
    of the knots and every power, the lowest first, the splines that do not vanish there.

    Reference:
        Piegl and Tiller, The NURBS Book, algorithm A2.2.
    """
    return _pieces(knots.tobytes(), degree)


@lru_cache(maxsize=64)
def _pieces(knots: bytes, degree: int) -> Array:
    t = np.frombuffer(knots)
    low = np.arange(degree, len(t) - degree - 1)
    ladder = np.zeros((len(low), 1, degree + 1))
    ladder[:, 0, 0] = 1.0
    with np.errstate(divide="ignore", invalid="ignore"):  # pieces of no length are never asked for
        for d in range(1, degree + 1):
            i = low[:, None] + np.arange(d)
            left, right, here = t[i - d + 1], t[i + 1], t[low][:, None]
            share = ladder / (right - left)[..., None]
            times_x = np.concatenate([np.zeros_like(share[..., :1]), share[..., :-1]], axis=2)
            ladder = np.zeros((len(low), d + 1, degree + 1))
            ladder[:, :-1] += (right - here)[..., None] * share - times_x
            ladder[:, 1:] += (here - left)[..., None] * share + times_x
    return np.ascontiguousarray(np.swapaxes(ladder, 1, 2))


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

    def plus(self, other: "Jet", factor: float) -> "Jet":
        """The jet of the sum of two height fields, the second times a factor."""
        return Jet(
            h=self.h + factor * other.h,
            hu=self.hu + factor * other.hu,
            hv=self.hv + factor * other.hv,
            huu=self.huu + factor * other.huu,
            huv=self.huv + factor * other.huv,
            hvv=self.hvv + factor * other.hvv,
        )
