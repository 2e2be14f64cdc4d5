"""Largest sums over touches under quotas of poses and features."""

from dataclasses import dataclass

import numpy as np
from scipy.sparse import csr_array, vstack

from matstd.information.selection.touch_selection import Quota, level
from matstd.twin.errors import DesignError
from matstd.twin.frames import Array, IntArray, Mask


@dataclass(frozen=True, eq=False)
class Sum:
    """Fractions of the largest sum, and what no fractions can exceed."""

    most: float  # no fractions have a larger sum: proven by its multipliers, not by a solver's word
    x: Array  # fractions that come near it, (N,)


def cells(quotas: tuple[Quota, ...], count: int) -> IntArray:
    """Rows of the same kinds in every quota have the same number, (N,), from 0."""
    if not quotas:
        return np.zeros(count, dtype=np.int64)
    kinds = np.stack([q.kind for q in quotas], axis=1)
    return np.unique(kinds, axis=0, return_inverse=True)[1].ravel()


def largest_sum(gain: Array, count: int, quotas: tuple[Quota, ...] = ()) -> Sum:
    """Largest ``sum x_i g_i`` with ``0 <= x_i <= 1``, ``sum x_i = count`` and the shares kept.

    With multipliers ``mu, nu >= 0`` of the shares it is at most the sum of the `count` largest
    ``g_i - mu_kind + nu_kind`` plus ``mu . most - nu . least``, whatever they are; a linear program
    finds good ones.

    Raises:
        DesignError: No fractions keep the shares.
    """
    from scipy.optimize import linprog  # a third of a second, in processes that choose nothing

    x = np.zeros(len(gain))
    if not quotas:
        top = np.argpartition(gain, len(gain) - count)[len(gain) - count :]
        x[top] = 1.0
        return Sum(float(gain[top].sum()), x)
    # rows of a cell differ in gain alone: only its best can enter, up to the number of its shares;
    # the next one gives the share its multiplier, without which the bound is loose
    room = np.min([q.most[q.kind] for q in quotas], axis=0)
    few = np.flatnonzero(rank_in_cell(gain, cells(quotas, len(gain))) <= np.minimum(room, count))
    A, b = _constraints(quotas, few)
    scale = float(np.abs(gain).max()) or 1.0
    found = linprog(
        -gain[few] / scale,
        A_ub=A,
        b_ub=b,
        A_eq=np.ones((1, len(few))),
        b_eq=[count],
        bounds=(0.0, 1.0),
        method="highs",
    )
    if found.status != 0:
        raise DesignError(f"no {count} of {len(gain)} touches keep the shares of poses and kinds")
    x[few] = np.clip(found.x, 0.0, 1.0)
    multipliers = scale * np.maximum(-found.ineqlin.marginals, 0.0)
    everything, limits = _constraints(quotas, np.arange(len(gain)))
    reduced = gain - everything.T @ multipliers
    top = np.partition(reduced, len(gain) - count)[len(gain) - count :]
    return Sum(float(top.sum() + multipliers @ limits), x)


def rank_in_cell(gain: Array, cell: IntArray) -> IntArray:
    """Rank of every row among those of its cell, the largest gain first, (N,), from 0."""
    order = np.lexsort((-gain, cell))
    start = np.searchsorted(cell[order], np.arange(int(cell.max()) + 1))
    rank = np.empty(len(gain), dtype=np.int64)
    rank[order] = np.arange(len(gain)) - start[cell[order]]
    return rank


def _constraints(quotas: tuple[Quota, ...], rows: IntArray) -> tuple[csr_array, Array]:
    """Shares as ``A x <= b`` over some rows."""
    parts, limits = [], []
    for quota in quotas:
        place = (np.ones(len(rows)), (quota.kind[rows], np.arange(len(rows))))
        counts = csr_array(place, shape=(len(quota.most), len(rows)))
        parts.append(counts)
        limits.append(quota.most)
        if quota.least is not None:
            parts.append(-counts)
            limits.append(-quota.least)
    return csr_array(vstack(parts)), np.concatenate(limits).astype(np.float64)


def heaviest(weight: Array, count: int, quotas: tuple[Quota, ...] = ()) -> Mask:
    """The `count` rows of the largest weights that keep the shares, (N,); raises DesignError."""
    chosen = np.zeros(len(weight), dtype=bool)
    weight = level(weight, weight.max(initial=0.0))
    if quotas:
        # the corners of the shares of poses and kinds are whole numbers; a tiny unevenness keeps
        # ties from leaving halves
        uneven = 1e-9 * np.random.default_rng(0).random(len(weight))
        weight = largest_sum(weight + uneven, count, quotas).x
    for row in np.argsort(-weight, kind="stable"):
        if int(chosen.sum()) == count:
            break
        if all(q.count(chosen)[q.kind[row]] < q.most[q.kind[row]] for q in quotas):
            chosen[row] = True
    if int(chosen.sum()) != count or any(not keeps(q, chosen) for q in quotas):
        raise DesignError(f"no {count} of {len(weight)} touches found that keep the shares")
    return chosen


def keeps(quota: Quota, x: Array | Mask) -> bool:
    """Whether fractions or a choice keep a quota."""
    slack = 1e-9 * len(x)
    count = np.bincount(quota.kind, weights=x.astype(np.float64), minlength=len(quota.most))
    least = np.zeros(len(quota.most)) if quota.least is None else quota.least
    return bool(np.all(count <= quota.most + slack) and np.all(count >= least - slack))
