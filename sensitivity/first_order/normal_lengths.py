"""Volumetric error without sampling: the length of a normally distributed deviation.

To first order the deviation of the tip is a sum of many independent errors of mean zero, so nearly
normal, d ~ N(0, C). Mean and quantiles of |d| divided by its root mean square depend on two ratios
of the eigenvalues of C and on nothing else, so a small table gives them for every pose. With
``d = r sqrt(w C w)``, w even over the sphere and r of the chi distribution with three degrees of
freedom, they are integrals over an eighth of the sphere:

    E|d| = sqrt(8 / pi) mean_w s(w),    P(|d| <= x) = mean_w F(x / s(w)),    s^2 = w^T C w.

It is exact for normal errors. Errors of bounded, two-sided amplitude have shorter tails: where a
few of them make the deviation, Monte Carlo is right and this is the check beside it.
"""

from dataclasses import dataclass
from functools import lru_cache

import numpy as np

from matstd.twin.frames import Array

LEVELS = (0.5, 0.95, 0.99)
_START = (0.67, 1.6, 1.94)  # below every quantile of a length with root mean square one
_KNOTS = 17  # of the integrated table, in each ratio
_FINE = 241  # of the table that is read linearly, made of the other by splines
_NODES = 32  # of the quadrature, in each of two angles


@dataclass(frozen=True, eq=False)
class NormalLength:
    """Length |d| of a normal vector at N poses, mm."""

    rms: Array  # shape (N,)
    mean: Array  # shape (N,)
    levels: tuple[float, ...]  # probabilities of the quantiles, (Q,)
    quantile: Array  # shape (Q, N)

    @property
    def sd(self) -> Array:
        """Standard deviation of the length, (N,)."""
        return np.sqrt(np.maximum(self.rms**2 - self.mean**2, 0.0))

    @property
    def p95(self) -> Array:
        """95 % stay below this, (N,)."""
        return self.quantile[self.levels.index(0.95)]


def normal_length(C: Array) -> NormalLength:
    """Mean and quantiles of |d| for d ~ N(0, C).

    Args:
        C: Covariances, shape (N, 3, 3), mm^2.
    """
    first, second, third = np.sqrt(principal(C))
    rms = np.sqrt(first**2 + second**2 + third**2)
    table = _table()
    whole = [np.divide(a, b, out=np.zeros_like(a), where=b > 0.0) for a, b in
             ((second, first), (third, second))]  # fmt: skip
    at = [np.clip(w, 0.0, 1.0) * (_FINE - 1) for w in whole]
    (i, j) = (np.minimum(a.astype(np.intp), _FINE - 2) for a in at)
    u, v = at[0] - i, at[1] - j
    corner = i * _FINE + j
    low = table[corner] * (1.0 - v)[:, None] + table[corner + 1] * v[:, None]
    high = table[corner + _FINE] * (1.0 - v)[:, None] + table[corner + _FINE + 1] * v[:, None]
    each = (low * (1.0 - u)[:, None] + high * u[:, None]).T * rms
    return NormalLength(rms, each[0], LEVELS, each[1:])


def principal(C: Array) -> Array:
    """Eigenvalues of symmetric, positive semidefinite matrices, largest first, (3, N).

    Args:
        C: Shape (N, 3, 3).

    Reference:
        Smith, Comm. ACM 4 (1961) 168: the characteristic equation by a cosine.
    """
    a, b, c = C[:, 0, 0], C[:, 1, 1], C[:, 2, 2]
    d, e, f = C[:, 0, 1], C[:, 1, 2], C[:, 0, 2]
    middle = (a + b + c) / 3.0
    a, b, c = a - middle, b - middle, c - middle
    spread = np.sqrt((a * a + b * b + c * c + 2.0 * (d * d + e * e + f * f)) / 6.0)
    half = 0.5 * (a * (b * c - e * e) - d * (d * c - e * f) + f * (d * e - b * f))
    cube = spread**3
    ratio = np.divide(half, cube, out=np.ones_like(half), where=cube > 0.0)
    angle = np.arccos(np.clip(ratio, -1.0, 1.0)) / 3.0
    largest = middle + 2.0 * spread * np.cos(angle)
    smallest = middle + 2.0 * spread * np.cos(angle + 2.0 * np.pi / 3.0)
    values = np.stack([largest, 3.0 * middle - largest - smallest, smallest])
    return np.maximum(values, 0.0)


@lru_cache(maxsize=1)
def _table() -> Array:
    """Mean and quantiles for a root mean square of one, (_FINE^2, 1 + Q).

    Rows over the square roots of the second to the first and of the third to the second eigenvalue,
    the latter fastest.
    """
    from scipy.interpolate import RectBivariateSpline

    knots, fine = np.linspace(0.0, 1.0, _KNOTS), np.linspace(0.0, 1.0, _FINE)
    first, second = (m.ravel() for m in np.meshgrid(knots, knots, indexing="ij"))
    values = integrated(np.stack([np.ones_like(first), first, first * second], axis=1))
    smooth = [
        RectBivariateSpline(knots, knots, v.reshape(_KNOTS, _KNOTS), s=0)(fine, fine)
        for v in values
    ]
    return np.stack([s.ravel() for s in smooth], axis=1)


def integrated(sd: Array) -> Array:
    """Mean and quantiles of |d| over its root mean square, by quadrature over the sphere.

    Args:
        sd: Standard deviations along the principal directions, largest first, (M, 3).

    Returns:
        Shape (1 + Q, M).
    """
    from scipy.special import erf

    nodes, weights = np.polynomial.legendre.leggauss(_NODES)
    z, turn = (0.5 * (nodes + 1.0), 0.25 * np.pi * (nodes + 1.0))
    weight = np.outer(0.5 * weights, 0.5 * weights).ravel()
    across = np.sqrt(1.0 - z * z)[:, None]
    w = np.stack([np.broadcast_to(z[:, None], (_NODES, _NODES)),
                  across * np.cos(turn), across * np.sin(turn)]).reshape(3, -1)  # fmt: skip
    out = np.empty((1 + len(LEVELS), len(sd)))
    for m, each in enumerate(sd / np.linalg.norm(sd, axis=1, keepdims=True)):
        s = np.sqrt(np.square(each) @ np.square(w))
        out[0, m] = np.sqrt(8.0 / np.pi) * (weight @ s)
        for k, level in enumerate(LEVELS):
            x = _START[k]
            for _ in range(6):  # Newton, from below on a concave function: never too far
                r = x / s
                density = np.sqrt(2.0 / np.pi) * r * np.exp(-0.5 * r * r)
                below = weight @ (erf(r / np.sqrt(2.0)) - density)
                x -= (below - level) / (weight @ (density * r / s))
            out[1 + k, m] = x
    return out
