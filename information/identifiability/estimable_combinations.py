"""Combinations of parameters that touches determine, best first, with their uncertainties."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from matstd.twin.frames import Array


@dataclass(frozen=True, eq=False)
class EstimableCombination:
    """A combination of parameters that touches determine by itself.

    ``sum_k weight_k theta_k`` with weight 1 at the leading parameter, in whose unit value and u
    are.
    """

    u: float  # standard uncertainty after the touches, base unit of the leading parameter
    gain: float  # prior over posterior standard deviation
    unit: str  # base unit of the leading parameter
    weights: Array  # of every parameter, (P,)
    importance: Array  # weights in units of what is expected of each parameter, (P,)
    value: float = np.nan  # estimate of a fit; not a number where nothing was measured


def combinations(
    W: Array, prior_sd: Array, units: Sequence[str], free: Sequence[int] = ()
) -> tuple[EstimableCombination, ...]:
    """Directions of the whitened rows that the touches know better than the prior.

    ``W^T W = V s^2 V^T``: the direction v has the posterior variance ``1/(1 + s^2)``.

    Args:
        W: Whitened rows, (N, P).
        free: Parameters that count as unknown and of no interest, such as a set-up: rows are first
            freed of what they can imitate.
    """
    kept = np.setdiff1d(np.arange(W.shape[1]), free)
    rows = W[:, kept]
    if len(free):
        U, s, _ = np.linalg.svd(W[:, list(free)], full_matrices=False)
        U = U[:, s > 1e-12 * s[0]]
        rows = rows - U @ (U.T @ rows)
    # R has the singular values of the rows at (P, P) instead of (N, P)
    _, s, Vt = np.linalg.svd(np.linalg.qr(rows, mode="r"))
    out = []
    for v, x in zip(Vt, s, strict=False):
        if x <= 1.0:
            break
        weights = np.zeros(W.shape[1])
        weights[kept] = v / prior_sd[kept]
        importance = weights * prior_sd
        size = np.abs(importance)
        lead = int(np.argmax(size > (1.0 - 1e-9) * size.max()))  # the first of equal ones
        scale = weights[lead]
        u = float(1.0 / (np.sqrt(1.0 + x * x) * abs(scale)))
        out.append(
            EstimableCombination(
                u=u,
                gain=float(np.sqrt(1.0 + x * x)),
                unit=units[lead],
                weights=weights / scale,
                importance=importance / scale,
            )
        )
    return tuple(out)
