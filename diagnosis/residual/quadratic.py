"""Probability of a ratio of quadratic forms in normal noise."""

import numpy as np

from matstd.information.power import exceedance
from matstd.twin.frames import Array


def ratio_probability(statistic: Array, weights: Array, dof: float) -> Array:
    """Probability that ``sum_i w_i z_i^2 / sum_j z_j^2`` is at least as large as observed.

    The z_j are dof independent standard normal numbers, of which the weights count the first ones.
    The event is ``sum_i (w_i - c) z_i^2 - c sum_rest z^2 > 0``, a quadratic form (`exceedance`).

    Args:
        statistic: Observed ratios c, shape (S,).
        weights: Non-negative, shape (S, K); zeros may pad them.
        dof: Number of normal numbers altogether; of more weights than that the largest count.

    Returns:
        Shape (S,).
    """
    c = np.asarray(statistic, dtype=float)[:, None]
    if weights.shape[1] > dof:
        weights = -np.sort(-weights, axis=1)[:, : max(int(dof), 1)]
    a = np.concatenate([weights - c, -c], axis=1)
    count = np.ones_like(a)
    count[:, -1] = max(float(dof) - weights.shape[1], 0.0)
    out = np.where(c[:, 0] > 0.0, 0.0, 1.0)
    possible = (out < 1.0) & (a.max(axis=1) > 1e-12 * c[:, 0])
    if possible.any():
        out[possible] = exceedance(a[possible], np.zeros_like(a[:1]), 0.0, count[possible])
    return np.clip(out, 1e-300, 1.0)
