"""How well touches distinguish explanations: expected log odds, and how often the odds suffice."""

from collections.abc import Sequence

import numpy as np

from matstd.twin.frames import Array

Predicted = tuple[Array, Array]
"""Mean (N,) and root of the covariance without noise (N, P), over the noise of a touch."""

LEAST_SHOWN = 0.03
"""Standard deviations by all touches below which an uncertain direction is left out: of 179 columns
96 remain."""


def separation(own: Predicted, other: Predicted) -> float:
    """Standard deviations between two predictions, as the other would see it, by all touches.

    ``sqrt(d^T (1 + S S^T)^-1 d)``: with S the root of the covariance of the other explanation, what
    its own uncertain parameters could make up for does not count.
    """
    d, S = own[0] - other[0], other[1]
    along = S.T @ d
    known = np.eye(S.shape[1]) + S.T @ S
    squared = float(d @ d - along @ np.linalg.solve(known, along))
    return float(np.sqrt(max(squared, 0.0)))


def greedy(own: Predicted, others: Sequence[Predicted], count: int) -> list[int]:
    """Touches that separate one prediction from others best, the most useful first.

    The next touch is the one at which the rival that is separated least so far differs most,
    over noise and what that rival does not know; the rival then learns from it.
    """
    d = np.array([own[0] - mean for mean, _ in others])
    S = [_thin(root) for _, root in others]
    gained, chosen = np.zeros(len(d)), list[int]()
    free = np.ones(d.shape[1], dtype=bool)
    for _ in range(min(count, d.shape[1])):
        k = int(np.argmin(gained))
        variance = 1.0 + np.einsum("np,np->n", S[k], S[k])
        i = int(np.argmax(np.where(free, d[k] ** 2 / variance, -1.0)))
        chosen.append(i)
        free[i] = False
        for r, root in enumerate(S):
            v = 1.0 + float(root[i] @ root[i])
            gained[r] += d[r, i] ** 2 / v
            # what the touch teaches: mean and covariance of all others given this one
            along = root @ root[i] / v
            d[r] = d[r] - d[r, i] * along
            S[r] = root - np.outer(along, root[i]) / (1.0 + np.sqrt(1.0 / v))
    return chosen


def _thin(root: Array) -> Array:
    """The same covariance in fewer columns: those that no touch would show are left out."""
    square, directions = np.linalg.eigh(root.T @ root)
    return np.asarray(root @ directions[:, square > LEAST_SHOWN**2])


def log_odds_drawn(
    predicted: Sequence[Predicted], true: int, draws: int, rng: np.random.Generator
) -> Array:
    """Log odds of one explanation against every other in visits that are drawn with it true.

    Args:
        true: Number of the explanation that holds.

    Returns:
        Shape (draws, explanations), 0 for the true one.
    """
    mean, root = predicted[true]
    y = mean + rng.normal(size=(draws, root.shape[1])) @ root.T
    y += rng.normal(size=y.shape)
    evidence = []
    for one, S in predicted:  # covariance 1 + S S^T: by Woodbury as small as S^T S
        L = np.linalg.cholesky(np.eye(S.shape[1]) + S.T @ S)
        r = (y - one).T
        known = np.linalg.solve(L, S.T @ r)
        square = (r**2).sum(axis=0) - (known**2).sum(axis=0)
        evidence.append(-0.5 * square - np.log(np.diag(L)).sum())
    found = np.array(evidence).T
    return np.asarray(found[:, [true]] - found)
