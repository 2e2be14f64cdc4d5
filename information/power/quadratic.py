"""Tails of weighted sums of noncentral chi-square variables, ``Q = sum_k w_k (z_k + d_k)^2``.

The cumulant function is closed, and Lugannani's and Rice's saddlepoint gives the tail from it:

    K(t) = sum_k ( -log(1 - 2 t w_k) / 2 + t w_k d_k^2 / (1 - 2 t w_k) ),   K'(t) = x
    P(Q > x) = 1 - Phi(r + log(v / r) / r),   r = sign(t) sqrt(2 (t x - K)),   v = t sqrt(K'')

Reference:
    D. Kuonen, Saddlepoint approximations for distributions of quadratic forms in normal variables,
    Biometrika 86 (1999) 929.
"""

import numpy as np
from scipy.special import ndtr

from matstd.twin.frames import Array

_STEPS = 60  # bisections: a relative interval of 1e-18
_NEAR_MEAN = 1e-4  # of r, below which the limit of the formula is taken


def exceedance(weight: Array, square: Array, x: float) -> Array:
    """Probability that Q exceeds x, (K,); to about 1 % of its value.

    Args:
        weight: Positive weights, (M,).
        square: Squares of the means ``d^2``, (K, M), one row a case.
        x: Above zero.
    """
    w, d2 = np.asarray(weight), np.atleast_2d(square)
    t = _saddlepoint(w, d2, x)
    left = 1.0 - 2.0 * t[:, None] * w
    K = np.sum(-0.5 * np.log(left) + t[:, None] * w * d2 / left, axis=1)
    K2 = np.sum(2.0 * w**2 / left**2 + 4.0 * w**2 * d2 / left**3, axis=1)
    r = np.sign(t) * np.sqrt(np.maximum(2.0 * (t * x - K), 0.0))
    near = np.abs(r) < _NEAR_MEAN
    safe, v = np.where(near, 1.0, r), np.where(near, 1.0, t * np.sqrt(K2))
    third = np.sum(8.0 * w**3 + 24.0 * w**3 * d2, axis=1)
    middle = 0.5 - third / (6.0 * np.sqrt(2.0 * np.pi) * K2**1.5)
    return np.where(near, middle, ndtr(-(safe + np.log(v / safe) / safe)))


def quantile(weight: Array, risk: float) -> float:
    """The x that the central Q exceeds with probability `risk`."""
    none = np.zeros((1, len(weight)))
    low, high = 0.0, float(np.sum(weight) + 40.0 * np.sqrt(2.0 * np.sum(weight**2)))
    for _ in range(_STEPS):
        middle = 0.5 * (low + high)
        if exceedance(weight, none, middle)[0] > risk:
            low = middle
        else:
            high = middle
    return high


def _saddlepoint(w: Array, d2: Array, x: float) -> Array:
    """The t with ``K'(t) = x`` of every case, (K,): K' rises from 0 to infinity."""
    end = 0.5 / w.max()
    # K' is below (sum w + sum w d^2) / (1 - 2 t w_min) for negative t, so t never is below this
    low = -0.5 * (len(w) + d2.sum(axis=1)) / x
    high = np.full(len(d2), end)
    for _ in range(_STEPS):
        t = 0.5 * (low + high)
        left = 1.0 - 2.0 * t[:, None] * w
        above = np.sum(w / left + w * d2 / left**2, axis=1) > x
        low, high = np.where(above, low, t), np.where(above, t, high)
    return low
