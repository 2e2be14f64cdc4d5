"""Combinations of parameters that touches determine, best first, with their uncertainties."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from twin.frames import Array
from twin.units import shown

NAMED = 4
"""Most parameters that are written out in the words of a combination."""

SHARE = 0.1
"""A parameter below this share of the largest weight is left out of the words."""


@dataclass(frozen=True, eq=False)
class EstimableCombination:
    """A combination of parameters that touches determine by itself.

    ``sum_k weight_k theta_k`` with weight 1 at the leading parameter, in whose unit u is.

    Attributes:
        words: Its dominant parameters, the leading one first.
        u: Standard uncertainty after the touches, base unit of the leading parameter.
        gain: Prior over posterior standard deviation.
        unit: Base unit of the leading parameter.
        weights: Of every parameter, (P,).
    """

    words: str
    u: float
    gain: float
    unit: str
    weights: Array


def combinations(
    W: Array, prior_sd: Array, names: Sequence[str], units: Sequence[str], free: Sequence[int] = ()
) -> tuple[EstimableCombination, ...]:
    """Directions of the whitened rows that the touches know better than the prior.

    ``W^T W = V s^2 V^T``: the direction v has the posterior variance ``1/(1 + s^2)``.

    Args:
        W: Whitened rows, (N, P).
        prior_sd: Shape (P,).
        names: Of the parameters.
        units: Their base units.
        free: Parameters that count as unknown and of no interest, such as a set-up: rows are first
            freed of what they can imitate.
    """
    kept = np.setdiff1d(np.arange(W.shape[1]), free)
    rows = W[:, kept]
    if len(free):
        U, s, _ = np.linalg.svd(W[:, list(free)], full_matrices=False)
        U = U[:, s > 1e-12 * s[0]]
        rows = rows - U @ (U.T @ rows)
    _, s, Vt = np.linalg.svd(np.linalg.qr(rows, mode="r"))
    out = []
    for v, x in zip(Vt, s, strict=False):
        if x <= 1.0:
            break
        weights = np.zeros(W.shape[1])
        weights[kept] = v / prior_sd[kept]
        importance = weights * prior_sd
        lead = int(np.argmax(np.abs(importance)))
        scale = weights[lead]
        u = float(1.0 / (np.sqrt(1.0 + x * x) * abs(scale)))
        words = combination_words(names, weights / scale, importance / scale, units)
        gain = float(np.sqrt(1.0 + x * x))
        out.append(EstimableCombination(words, u, gain, units[lead], weights / scale))
    return tuple(out)


def combination_words(
    names: Sequence[str], weights: Array, importance: Array, units: Sequence[str]
) -> str:
    """`EXX + 0.52 EXZ - 0.03 µm/µrad EBX ...`: the most important parameters with their weights.

    Args:
        names: Of the parameters.
        weights: Shape (P,), the leading one's is one.
        importance: Weights in units of what is expected of each parameter, (P,).
        units: Base units of the parameters.
    """
    order = np.argsort(-np.abs(importance), kind="stable")
    kept = [k for k in order if abs(importance[k]) >= SHARE * abs(importance[order[0]])]
    label, factor = shown(units[order[0]])
    parts = []
    for k in kept[:NAMED]:
        sign = "-" if weights[k] < 0 else "+"
        own, size = shown(units[k]), abs(weights[k])
        words = f"{size * own[1] / factor:.3g}"
        per = "" if own[0] == label else f"{label}/{own[0]} "
        parts.append(f"{sign} {'' if words == '1' and not per else words + ' '}{per}{names[k]}")
    rest = len(kept) - NAMED
    return " ".join(parts).removeprefix("+ ") + (f" and {rest} more" if rest > 0 else "")
