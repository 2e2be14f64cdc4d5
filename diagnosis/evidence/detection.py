"""What an effect needs to be found by the search, and not merely to exceed chance.

Beside the chance of its own grid there are other effects that do nearly the same. One that does
more than `REPRODUCED` of it may be named instead, if it was more likely before; then its grid
decides the chance. One that does less must stay behind in evidence. Both are worked out for the
expected evidence of every variant beside a signature of a given length.
"""

import numpy as np
from scipy.special import fdtri

from matstd.diagnosis.evidence.effect_signatures import Signatures
from matstd.diagnosis.policy import POLICY
from matstd.twin.frames import Array, IntArray

REPRODUCED = 0.93**2
"""Share of a signature, as squares, that an effect must reproduce to be as right an answer."""

POINTS_OF_GRID = 5  # points of the grid of a rival that are compared

LENGTHS = np.geomspace(0.5, 12.0, 48)
"""Squared lengths that are tried, over the threshold of the effect by itself."""

RIDGE = 1e-9
"""Of the trace of a Gram matrix, added to its diagonal: columns of one effect may coincide."""


def needed_lengths(pool: Signatures, own: IntArray, prior: Array, E: Array, dof: float) -> Array:
    """Squared lengths of signatures that the search finds in four of five runs.

    Args:
        pool: All that is searched.
        own: Variants that are asked for, (M,).
        prior: Log prior of every variant, (V,).
        E: Products of the pool's columns with the set beside which they are found, (K, all).
        dof: Degrees of freedom of the noise.

    Returns:
        For every variant asked for the squared length over the variance of the noise, (M,); inf
        where no length that is tried does.
    """
    rivals = np.union1d(_thinned(pool), own)
    share = _shares(pool, own, rivals, E)
    k = pool.width[rivals].astype(float)
    chance = POLICY.false_alarm / (pool.tries[pool.owner[rivals]] * pool.tried)
    threshold = k * fdtri(k, dof, 1.0 - np.maximum(chance, 1e-15))
    alike = (share > REPRODUCED) | (pool.owner[rivals] == pool.owner[own][:, None])
    begin = threshold[np.searchsorted(rivals, own)]
    rows, longer = np.arange(len(own)), np.append(LENGTHS, np.inf)
    low, high = np.zeros_like(own), np.full_like(own, len(LENGTHS))
    while (low < high).any():  # a longer signature is found where a shorter one is
        middle = np.minimum((low + high) // 2, len(LENGTHS) - 1)
        length = LENGTHS[middle] * begin
        evidence = 0.5 * length[:, None] * share + prior[rivals]
        evidence -= 0.5 * k * np.log1p(length[:, None] / k)
        named = np.where(alike, evidence, -np.inf).argmax(axis=1)
        explained = share[rows, named]
        seen = length * explained
        spread = np.sqrt((2.0 * k[named] + 4.0 * seen) * (1.0 + 0.5 * seen / dof))
        is_beyond = k[named] + seen - POLICY.detection_power * spread >= threshold[named]
        ahead = evidence[rows, named][:, None] - np.where(alike, -np.inf, evidence)
        apart = np.sqrt(length[:, None] * np.maximum(explained[:, None] - share, 0.0))
        is_found = is_beyond & np.all(ahead >= POLICY.detection_power * apart, axis=1)
        low, high = np.where(is_found, low, middle + 1), np.where(is_found, middle, high)
    return longer[low] * begin


def _thinned(pool: Signatures) -> IntArray:
    """Variants at a few points of every grid."""
    grids = [np.flatnonzero(pool.owner == candidate) for candidate in range(len(pool.names))]
    few = [points[:: max(1, -(-len(points) // POINTS_OF_GRID))] for points in grids]
    return np.concatenate([np.zeros(0, dtype=np.int64), *few])


def _shares(pool: Signatures, own: IntArray, rivals: IntArray, E: Array) -> Array:
    """Share of the squares of every signature that every rival reproduces, (M, R)."""
    wanted = np.concatenate([np.arange(pool.start[v], pool.start[v + 1]) for v in own])
    whose = np.repeat(np.arange(len(own)), pool.width[own])
    C, mine = pool.C[:, wanted], E[:, wanted]
    whole = np.bincount(whose, (C**2).sum(axis=0) - (mine**2).sum(axis=0), len(own))
    out = np.zeros((len(own), len(rivals)))
    for width in np.unique(pool.width[rivals]):
        which = np.flatnonzero(pool.width[rivals] == width)
        cols = pool.start[rivals[which]][:, None] + np.arange(width)
        flat = cols.ravel()
        inside = (pool.C[:, flat].T @ C - E[:, flat].T @ mine).reshape(len(which), width, -1)
        place = np.searchsorted(pool.by_width[int(width)][0], rivals[which])
        free = np.einsum("kvi,kvj->vij", E[:, cols], E[:, cols])
        G = pool.gram[int(width)][place] - free
        ridge = RIDGE * np.trace(G, axis1=1, axis2=2) + 1e-12
        G = G + ridge[:, None, None] * np.eye(width)
        explained = (inside * np.linalg.solve(G, inside)).sum(axis=1)
        for m in range(len(own)):
            out[m, which] = explained[:, whose == m].sum(axis=1)
    return np.clip(out / np.maximum(whole, 1e-300)[:, None], 0.0, 1.0)
