"""Parameters that touches tie together: correlations after the fit, pairs and groups.

Two parameters whose estimates rise and fall together (r near +1) are known by their difference;
where one falls as the other rises (r near -1) by their sum; difference and sum of both in units of
their spread. In either case the touches do not say which of the two it is.
"""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from scipy.sparse.csgraph import connected_components

from matstd.twin.errors import ShapeMismatch
from matstd.twin.frames import Array

STRONG_CORRELATION = 0.9
"""Absolute correlation from which two parameters count as tied."""


@dataclass(frozen=True)
class Pair:
    """Two tied parameters by their indices, and their correlation."""

    first: int
    second: int
    r: float


@dataclass(frozen=True, eq=False)
class Ties:
    """Parameters that touches tie together."""

    names: tuple[str, ...]
    r: Array  # correlations of all of them, (P, P)
    pairs: tuple[Pair, ...]  # tied ones, the strongest first
    # indices of parameters joined by ties, the largest group first, each in an order in which
    # neighbours are alike
    groups: tuple[tuple[int, ...], ...]


def correlation(covariance: Array) -> Array:
    """Correlations from covariances, (P, P); a parameter without variance has none with others."""
    sd = np.sqrt(np.diag(covariance))
    scale = np.where(sd > 0.0, sd, 1.0)
    r = np.clip(covariance / np.outer(scale, scale), -1.0, 1.0)
    np.fill_diagonal(r, 1.0)
    return r


def ties(covariance: Array, names: Sequence[str], strong: float = STRONG_CORRELATION) -> Ties:
    """Parameters that are tied after a fit with a covariance (P, P); raises ShapeMismatch.

    A pair counts from the absolute correlation `strong` on, between 0 and 1.
    """
    if covariance.shape != (len(names), len(names)):
        raise ShapeMismatch(f"covariance of shape {covariance.shape} for {len(names)} names")
    r = correlation(covariance)
    rows, columns = np.nonzero(np.triu(np.abs(r) >= strong, 1))
    order = np.argsort(-np.abs(r[rows, columns]), kind="stable")
    pairs = tuple(
        Pair(i, j, float(r[i, j]))
        for i, j in zip(rows[order].tolist(), columns[order].tolist(), strict=True)
    )
    return Ties(tuple(names), r, pairs, _groups(pairs, r))


def _groups(pairs: Sequence[Pair], r: Array) -> tuple[tuple[int, ...], ...]:
    """Parameters joined by ties, directly or through others."""
    tied = np.zeros(r.shape, dtype=bool)
    tied[[p.first for p in pairs], [p.second for p in pairs]] = True
    of = connected_components(tied, directed=False)[1]
    members = (np.flatnonzero(of == k).tolist() for k in np.unique(of))
    ordered = (tuple(_alike_beside_alike(m, r)) for m in members if len(m) > 1)
    return tuple(sorted(ordered, key=lambda group: (-len(group), group)))


def _alike_beside_alike(group: list[int], r: Array) -> list[int]:
    """Order from the parameter of the strongest ties, each followed by its nearest one."""
    left = list(group)
    strength = np.abs(r[np.ix_(group, group)]).sum(axis=1)
    out = [left.pop(int(np.argmax(strength)))]
    while left:
        out.append(left.pop(int(np.argmax(np.abs(r[out[-1], left])))))
    return out
