"""Touches that prove a model: on freeform faces, which had no part in identifying it.

A proof measures surfaces, not single points: every part of every face has a touch near it, as many
on a square centimetre of one face as of another, so that what a model leaves is seen as a pattern.
Where the touches lie is therefore chosen by how evenly they cover the faces; only at which table
pose each is made is chosen by its information.
"""

import numpy as np

from matstd.artefact.body import FreeformPatch, Standard
from matstd.artefact.place.covering import covering, even_shares
from matstd.artefact.reach import ProbeReach, Requests, joined
from matstd.artefact.worth import Criterion, each_at
from matstd.information.selection import Selection, fill
from matstd.twin.errors import NotReachable
from matstd.twin.frames import Array
from matstd.twin.record import IntArray

_PLACES = 1.8  # on a face for each touch that is wanted on it
_EDGE = 3.0  # mm a touch stays away from the trimmed edge, at least
_CROWDED = 1.25  # even shares of the touches that one table pose may have, if all can be had


def touches_on_faces(reach: ProbeReach, standard: Standard, poses: Array, count: int) -> Requests:
    """Touches that can be made, to choose `count` from: all over the faces, at every pose."""
    pitch = int(np.ceil(np.sqrt(_PLACES * count / len(standard.patches))))
    grids = [each_at(face, _middles_of_cells(face, pitch), poses) for face in standard.patches]
    wanted = joined(grids)
    wanted = wanted[reach.is_reachable(wanted)]
    return wanted[reach.is_clear(standard, wanted)]


def proving_touches(
    criterion: Criterion,
    standard: Standard,
    tried: Requests,
    identifying: Requests,
    count: int,
) -> Requests:
    """Touches that cover the faces evenly, at the most informative table poses.

    Args:
        criterion: On the standard, faces and balls.
        standard: With the faces.
        tried: Touches to choose from, none of which identifies.
        identifying: Touches that do.
        count: How many prove.

    Raises:
        NotReachable: Too few can be made.
    """
    _check_enough(tried, count)
    place = np.unique(tried.point, axis=0, return_inverse=True)[1].reshape(-1)
    kept = np.isin(place, _even_places(standard, tried, place, count))
    tried, place = tried[kept], np.unique(place[kept], return_inverse=True)[1]
    selection, given = _beside(criterion, tried, identifying)
    _at_poses(selection, given, place, tried.pose, count)
    return tried[selection.chosen[given:]]


def informative_touches(
    criterion: Criterion, tried: Requests, identifying: Requests, count: int
) -> Requests:
    """Most informative touches beside the ones that identify.

    Args:
        criterion: On the standard, faces and balls.
        tried: Touches to choose from.
        identifying: Touches made anyway.
        count: How many are chosen.

    Raises:
        NotReachable: Fewer can be made.
    """
    _check_enough(tried, count)
    selection, given = _beside(criterion, tried, identifying)
    fill(selection, given + count)
    return tried[selection.chosen[given:]]


def _beside(criterion: Criterion, tried: Requests, identifying: Requests) -> tuple[Selection, int]:
    """Touches to choose from behind those that are in; and the number of these."""
    given = len(identifying)
    start = np.arange(given + len(tried)) < given
    return Selection(
        criterion.objective, criterion.rows(joined([identifying, tried])), start
    ), given


def _at_poses(
    selection: Selection, given: int, place: IntArray, pose: IntArray, count: int
) -> None:
    """Choose touches at every place, the most informative at poses that have room.

    Places with the fewest such poses come first, so that something is left for them; where nothing
    is, the least crowded pose takes one more.

    Args:
        selection: Is filled.
        given: Number of its first rows, which are in.
        place: Of every other row, (N,).
        pose: Of every other row, (N,).
        count: How many are chosen.
    """
    there = np.bincount(place)
    wanted, used = even_shares(np.ones(len(there)), there, count), np.zeros(pose.max() + 1, int)
    most = np.ceil(_CROWDED * count / len(used))
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
    """Places of touches that cover the parts of the faces that can be touched."""
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
    """Parameters of the middles of as many equal cells each way, (pitch^2, 2)."""
    axes = [
        np.linspace(-1.0, 1.0, pitch) * min(half * (1.0 - 1.0 / pitch), half - _EDGE)
        for half in face.half_size
    ]
    return np.stack(np.meshgrid(*axes, indexing="ij"), axis=-1).reshape(-1, 2)


def _check_enough(tried: Requests, count: int) -> None:
    if len(tried) < count:
        raise NotReachable(f"{len(tried)} touches can be made for the proof, {count} are wanted")
