"""Places that cover an area evenly: no part of it is far from all of them."""

import numpy as np

from matstd.twin.frames import Array
from matstd.twin.record import IntArray

_SWEEPS = 4  # looks at every place for a better one; two or three move any
_WORTH = 1e-9  # relative gain below which a place is not exchanged


def covering(area: Array, places: Array, count: int) -> IntArray:
    """Those places whose squared distance from all points of an area is least on average.

    Chosen one after the other, then exchanged one by one until none that is tried is better: a
    local optimum, as evenly spread as the middles of cells of equal size.

    Args:
        area: Points all over it, (S, D).
        places: To choose from, (P, D).
        count: How many, P at most.

    Returns:
        Their rows in `places`, (count,).
    """
    apart = np.sum((area[:, None] - places) ** 2, axis=-1)
    chosen = np.zeros(0, dtype=np.int64)
    for _ in range(count):
        chosen = np.append(chosen, _best_beside(apart, chosen)[0])
    for _ in range(_SWEEPS):
        before = chosen.copy()
        for i in range(count):
            best, cost = _best_beside(apart, np.delete(chosen, i))
            if cost < apart[:, chosen].min(axis=1).sum() * (1.0 - _WORTH):
                chosen[i] = best
        if (chosen == before).all():
            break
    return chosen


def _best_beside(apart: Array, chosen: IntArray) -> tuple[int, float]:
    """The place that leaves least beside some others, and what it leaves."""
    near = apart[:, chosen].min(axis=1, initial=float(apart.max()))
    cost = np.minimum(near[:, None], apart).sum(axis=0)
    cost[chosen] = np.inf
    best = int(np.argmin(cost))
    return best, float(cost[best])


def even_shares(weight: Array, room: IntArray, count: int) -> IntArray:
    """How many of `count` go to each of some areas, in proportion to weights as far as room is.

    One after the other, always to the area that has least for its weight (Sainte-Laguë).

    Args:
        weight: Of each area, (F,).
        room: Most that each takes, (F,), no fewer than `count` together.
        count: How many.
    """
    given = np.zeros(len(weight), dtype=np.int64)
    for _ in range(count):
        lacking = np.where(given < room, weight / (given + 0.5), -1.0)
        given[np.argmax(lacking)] += 1
    return given
