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
from typing import Any

import numpy as np

from matstd.twin.frames import Array
from matstd.twin.sampling import grid_points

LEVELS = (0.5, 0.95, 0.99)
_START = (0.67, 1.6, 1.94)  # below every quantile of a length with root mean square one
_KNOTS = 17  # of the splines, in each ratio
_NODES = 32  # of the quadrature, in each of two angles


@dataclass(frozen=True, eq=False)
class NormalLength:
    """Length |d| of a normal vector at N poses, mm."""

    rms: Array  # shape (N,)
    mean: Array  # shape (N,)
    levels: tuple[float, ...]  # probabilities of the quantiles, (Q,)
    quantile: Array  # shape (Q, N)

    @property
    def p95(self) -> Array:
        """95 % stay below this, (N,)."""
        return self.quantile[self.levels.index(0.95)]


def normal_length(C: Array) -> NormalLength:
    """Mean and quantiles of |d| for d ~ N(0, C), covariances of shape (N, 3, 3), mm^2."""
    third, second, first = np.sqrt(np.maximum(np.linalg.eigvalsh(C), 0.0)).T
    rms = np.sqrt(first**2 + second**2 + third**2)
    # not more than one where eigenvalues are equal but for rounding
    ratios = [
        np.minimum(np.divide(a, b, out=np.zeros_like(a), where=b > 0.0), 1.0)
        for a, b in ((second, first), (third, second))
    ]
    mean, *quantile = (spline.ev(*ratios) * rms for spline in _splines())
    return NormalLength(rms, mean, LEVELS, np.stack(quantile))


@lru_cache(maxsize=1)
def _splines() -> list[Any]:
    """Mean and quantiles for a root mean square of one.

    Over the square roots of the second to the first and of the third to the second eigenvalue.
    """
    from scipy.interpolate import RectBivariateSpline

    knots = np.linspace(0.0, 1.0, _KNOTS)
    first, second = grid_points(knots, knots).T
    values = integrated(np.stack([np.ones_like(first), first, first * second], axis=1))
    return [RectBivariateSpline(knots, knots, v.reshape(_KNOTS, _KNOTS), s=0) for v in values]


def integrated(sd: Array) -> Array:
    """Mean and quantiles of |d| over its root mean square, by quadrature on the sphere, (1 + Q, M).

    For standard deviations along the principal directions, largest first, (M, 3).
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
