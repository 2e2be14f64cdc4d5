"""Tail probabilities of quadratic forms in normal noise, by the saddlepoint."""

import numpy as np
from scipy.special import log_ndtr

from matstd.twin.frames import Array

HALVINGS = 36  # of the bracket: 2^-36 is far below what a probability is quoted to


def ratio_probability(statistic: Array, weights: Array, dof: float) -> Array:
    """Probability that ``sum_i w_i z_i^2 / sum_j z_j^2`` is at least as large as observed.

    The z_j are dof independent standard normal numbers, of which the weights count the first ones.
    The event is ``sum_i (w_i - c) z_i^2 - c sum_rest z^2 > 0``, a quadratic form whose tail the
    formula of Lugannani and Rice gives to a few per cent, also far out.

    Args:
        statistic: Observed ratios c, shape (S,).
        weights: Non-negative, shape (S, K); zeros may pad them.
        dof: Number of normal numbers altogether; of more weights than that the largest count.

    Returns:
        Shape (S,).

    Reference:
        Lugannani and Rice 1980; Kuonen 1999 (quadratic forms).
    """
    c = np.asarray(statistic, dtype=float)[:, None]
    if weights.shape[1] > dof:
        weights = -np.sort(-weights, axis=1)[:, : max(int(dof), 1)]
    a = weights - c
    rest = max(float(dof) - weights.shape[1], 0.0)
    largest = a.max(axis=1)
    possible = largest > 1e-12 * np.maximum(c[:, 0], 1e-300)
    out = np.zeros(len(c))
    if possible.any():
        out[possible] = _tail(a[possible], c[possible, 0], rest)
    return np.clip(out, 1e-300, 1.0)


def _tail(a: Array, c: Array, rest: float) -> Array:
    """P(sum a z^2 - c chi2_rest > 0) for rows with at least one positive a."""
    high = 0.5 / a.max(axis=1)
    low = -0.5 / np.maximum(c, np.maximum(-a.min(axis=1), 1e-300))
    lower, upper = low * (1.0 - 1e-12), high * (1.0 - 1e-12)
    for _ in range(HALVINGS):
        s = 0.5 * (lower + upper)
        up = _slope(s, a, c, rest) < 0.0
        lower, upper = np.where(up, s, lower), np.where(up, upper, s)
    s = 0.5 * (lower + upper)
    factors = 1.0 - 2.0 * s[:, None] * a
    base = 1.0 + 2.0 * s * c
    K = -0.5 * np.log(factors).sum(axis=1) - 0.5 * rest * np.log(base)
    curvature = 2.0 * ((a / factors) ** 2).sum(axis=1) + 2.0 * rest * (c / base) ** 2
    w = np.sign(s) * np.sqrt(np.maximum(-2.0 * K, 0.0))
    v = s * np.sqrt(curvature)
    middle = np.abs(w) < 1e-3  # the formula is 0/0 at the mean, where no digits are needed
    safe = np.where(middle, 1.0, w)
    corrected = safe + np.log(np.where(middle, 1.0, v / safe)) / safe
    return np.asarray(np.where(middle, 0.5, np.exp(log_ndtr(-corrected))))


def _slope(s: Array, a: Array, c: Array, rest: float) -> Array:
    """Derivative of the cumulant function."""
    inside = (a / (1.0 - 2.0 * s[:, None] * a)).sum(axis=1)
    return np.asarray(inside - rest * c / (1.0 + 2.0 * s * c))
