"""Tails of weighted sums of chi-square variables, ``Q = sum_k w_k chi^2(n_k, d_k^2)``.

The cumulant function is closed, and Lugannani's and Rice's saddlepoint gives the tail from it:

    K(t) = sum_k ( -n_k log(1 - 2 t w_k) / 2 + t w_k d_k^2 / (1 - 2 t w_k) ),   K'(t) = x
    P(Q > x) = 1 - Phi(r + log(v / r) / r),   r = sign(t) sqrt(2 (t x - K)),   v = t sqrt(K'')

Reference:
    D. Kuonen, Saddlepoint approximations for distributions of quadratic forms in normal variables,
    Biometrika 86 (1999) 929.
"""

import numpy as np
from scipy.special import log_ndtr

from matstd.twin.frames import Array

_STEPS = 44  # bisections: a relative interval of 1e-13
_NEAR_MEAN = 1e-4  # of r, below which the limit of the formula is taken


def exceedance(weight: Array, square: Array, x: float, count: Array | None = None) -> Array:
    """Probability that Q exceeds x, (K,); to about 1 % of its value, also far out.

    Args:
        weight: Weights, (M,) or (K, M), at least one of a row positive.
        square: Squares of the means ``d^2``, (K, M) or (M,).
        x: Above zero if no weight is negative.
        count: Degrees of freedom, as the weights; 1 without.
    """
    w, d2 = np.atleast_2d(weight), np.atleast_2d(square)
    n = np.ones_like(w) if count is None else count
    t = _saddlepoint(w, d2, n, x)
    left = 1.0 - 2.0 * t[:, None] * w
    K = np.sum(t[:, None] * w * d2 / left - 0.5 * n * np.log(left), axis=1)
    K2 = np.sum(2.0 * w**2 * (n + 2.0 * d2 / left) / left**2, axis=1)
    r = np.sign(t) * np.sqrt(np.maximum(2.0 * (t * x - K), 0.0))
    near = np.abs(r) < _NEAR_MEAN
    safe, v = np.where(near, 1.0, r), np.where(near, 1.0, t * np.sqrt(K2))
    third = np.sum(8.0 * w**3 * (n + 3.0 * d2), axis=1)
    middle = 0.5 - third / (6.0 * np.sqrt(2.0 * np.pi) * K2**1.5)
    return np.where(near, middle, np.exp(log_ndtr(-(safe + np.log(v / safe) / safe))))


def quantile(weight: Array, risk: float) -> float:
    """The x that the central Q exceeds with probability `risk`."""
    from scipy.optimize import brentq

    none = np.zeros_like(weight)
    high = float(np.sum(weight) + 40.0 * np.sqrt(2.0 * np.sum(weight**2)))
    return float(brentq(lambda x: exceedance(weight, none, x)[0] - risk, 1e-12 * high, high))


def _saddlepoint(w: Array, d2: Array, n: Array, x: float) -> Array:
    """The t with ``K'(t) = x`` of every case, (K,): K' rises to infinity at the largest weight."""
    high, least = 0.5 / w.max(axis=1), w.min(axis=1)
    # K' is -infinity at a negative weight; without one it is below (sum n + sum d^2) / (-2 t)
    with np.errstate(divide="ignore"):
        low = np.where(least < 0.0, 0.5 / least, -0.5 * (n.sum(axis=1) + d2.sum(axis=1)) / x)
    low, high = np.broadcast_arrays(low, high)
    for _ in range(_STEPS):
        t = 0.5 * (low + high)
        left = 1.0 - 2.0 * t[:, None] * w
        above = np.sum((n + d2 / left) * w / left, axis=1) > x
        low, high = np.where(above, low, t), np.where(above, t, high)
    return 0.5 * (low + high)
