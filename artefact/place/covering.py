"""Places that cover an area evenly: greedy choice, then exchange of single places."""

import numpy as np

from matstd.twin.frames import Array, IntArray

_SWEEPS = 4  # sweeps over all places; only two or three change any
_MIN_GAIN = 1e-9  # relative gain below which a place is not exchanged


def covering(area: Array, places: Array, count: int) -> IntArray:
    """Places with the least mean squared distance from all points of an area.

    A local optimum: chosen one after the other, then exchanged one by one.

    Args:
        area: Points of the area, (S, D).
        places: Candidates, (P, D).
        count: At most P.

    Returns:
        Their rows in `places`, (count,).
    """
    apart = np.sum((area[:, None] - places) ** 2, axis=-1)
    chosen = np.zeros(0, dtype=np.int64)
    for _ in range(count):
        chosen = np.append(chosen, _best_addition(apart, chosen)[0])
    for _ in range(_SWEEPS):
        before = chosen.copy()
        for i in range(count):
            best, cost = _best_addition(apart, np.delete(chosen, i))
            if cost < apart[:, chosen].min(axis=1).sum() * (1.0 - _MIN_GAIN):
                chosen[i] = best
        if (chosen == before).all():
            break
    return chosen


def _best_addition(apart: Array, chosen: IntArray) -> tuple[int, float]:
    """The place that reduces the cost most beside the chosen ones, and that cost."""
    near = apart[:, chosen].min(axis=1, initial=float(apart.max()))
    cost = np.minimum(near[:, None], apart).sum(axis=0)
    cost[chosen] = np.inf
    best = int(np.argmin(cost))
    return best, float(cost[best])


def even_shares(weight: Array, room: IntArray, count: int) -> IntArray:
    """Share `count` places among areas in proportion to weights, within the room of each.

    The method of Sainte-Laguë: the next place goes to the area with least for its weight.

    Args:
        weight: Of each area, (F,).
        room: Most that each takes, (F,), no fewer than `count` together.
    """
    given = np.zeros(len(weight), dtype=np.int64)
    for _ in range(count):
        lacking = np.where(given < room, weight / (given + 0.5), -1.0)
        given[np.argmax(lacking)] += 1
    return given
