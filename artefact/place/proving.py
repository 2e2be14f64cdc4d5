"""Touches that prove a model, on freeform faces that did not identify it.

A proof measures surfaces, not single points: touches cover all faces with equal density, so that
residuals appear as a pattern. Their places are therefore chosen by even coverage; only the table
pose of each touch is chosen by its information.
"""

import numpy as np

from matstd.artefact.body import FreeformPatch, Standard
from matstd.artefact.reach import ProbeReach, Requests, joined
from matstd.artefact.worth import Criterion, each_at
from matstd.information.selection import Selection, fill
from matstd.twin.errors import NotReachable
from matstd.twin.frames import Array, IntArray
from matstd.twin.sampling import grid_points

_PLACES_PER_TOUCH = 1.8  # candidate places per wanted touch
_EDGE = 3.0  # mm a touch stays away from the trimmed edge, at least
_POSE_CROWDING = 1.25  # touches of one table pose, relative to equal shares


def touches_on_faces(
    reach: ProbeReach,
    standard: Standard,
    poses: Array,
    count: int,
    per_touch: float = _PLACES_PER_TOUCH,
) -> Requests:
    """Possible touches all over the faces at every pose, from which `count` are chosen."""
    pitch = int(np.ceil(np.sqrt(per_touch * count / len(standard.patches))))
    grids = [each_at(face, _middles_of_cells(face, pitch), poses) for face in standard.patches]
    wanted = joined(grids)
    wanted = wanted[reach.is_reachable(wanted)]
    return wanted[reach.is_clear(standard, wanted)]


def proving_touches(
    criterion: Criterion, standard: Standard, tried: Requests, identifying: Requests, count: int
) -> Requests:
    """Touches that cover the faces evenly, at the best table poses; raises NotReachable."""
    _check_enough(tried, count)
    place = np.unique(tried.point, axis=0, return_inverse=True)[1].ravel()
    kept = np.isin(place, _even_places(standard, tried, place, count))
    tried, place = tried[kept], np.unique(place[kept], return_inverse=True)[1]
    selection, given = _selection_after(criterion, tried, identifying)
    _choose_poses(selection, given, place, tried.pose, count)
    return tried[selection.chosen[given:]]


def informative_touches(
    criterion: Criterion, tried: Requests, identifying: Requests, count: int
) -> Requests:
    """Most informative touches beside those that identify; raises NotReachable for fewer."""
    _check_enough(tried, count)
    selection, given = _selection_after(criterion, tried, identifying)
    fill(selection, given + count)
    return tried[selection.chosen[given:]]


def _selection_after(
    criterion: Criterion, tried: Requests, identifying: Requests
) -> tuple[Selection, int]:
    """A selection that begins with the identifying touches, and the number of these."""
    given = len(identifying)
    start = np.arange(given + len(tried)) < given
    return Selection(
        criterion.objective, criterion.rows(joined([identifying, tried])), start
    ), given


def _choose_poses(
    selection: Selection, given: int, place: IntArray, pose: IntArray, count: int
) -> None:
    """Choose touches at every place, the most informative at poses with room.

    Places with the fewest such poses come first, so that they still find one; if there is none,
    the least crowded pose takes one more.

    Args:
        given: Number of its first rows, which are already chosen.
        place: Of every other row, (N,).
        pose: Of every other row, (N,).
    """
    there = np.bincount(place)
    wanted, used = even_shares(np.ones(len(there)), there, count), np.zeros(pose.max() + 1, int)
    most = np.ceil(_POSE_CROWDING * count / len(used))
    for _ in range(count):
        free = ~selection.chosen[given:] & (wanted[place] > 0)
        room = free & (used[pose] < most)
        options = np.where(wanted > 0, np.bincount(place[room], minlength=len(there)), len(used))
        rows = (room if options.min() else free) & (options[place] == options.min())
        if not options.min():
            rows &= used[pose] == used[pose[rows]].min()
        best = int(np.argmax(np.where(rows, selection.gains[given:], -np.inf)))
        selection.add(given + best)
        used[pose[best]] += 1
        wanted[place[best]] -= 1


def _even_places(standard: Standard, tried: Requests, place: IntArray, count: int) -> IntArray:
    """Places that evenly cover the touchable parts of the faces."""
    first = np.unique(place, return_index=True)[1]
    on = [first[tried.feature[first] == face.name] for face in standard.patches]
    room = np.array([len(rows) for rows in on])
    area = np.array([np.prod(face.half_size) for face in standard.patches])
    shares = even_shares(area * room, room, min(count, len(first)))
    chosen = [
        rows[covering(face.point(face.grid()), tried.point[rows], share)]
        for face, rows, share in zip(standard.patches, on, shares.tolist(), strict=True)
    ]
    return place[np.concatenate(chosen)]


def _middles_of_cells(face: FreeformPatch, pitch: int) -> Array:
    """Parameters of the middles of pitch x pitch equal cells, (pitch^2, 2)."""
    axes = [
        np.linspace(-1.0, 1.0, pitch) * min(half * (1.0 - 1.0 / pitch), half - _EDGE)
        for half in face.half_size
    ]
    return grid_points(*axes)


def _check_enough(tried: Requests, count: int) -> None:
    if len(tried) < count:
        raise NotReachable(f"{len(tried)} touches can be made for the proof, {count} are wanted")


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
