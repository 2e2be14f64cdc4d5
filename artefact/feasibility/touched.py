"""Which faces the probe can touch, alone and beside each other.

A few touches on every face stand for all. Whether two faces hide each other is estimated from the
probe in contact alone, because the full check of every pair takes too long.
"""

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from matstd.artefact.body import DatumSphere, FreeformPatch, Standard
from matstd.artefact.layout import Blank, with_spheres
from matstd.artefact.reach import ProbeReach, Requests, joined
from matstd.artefact.worth import each_at, face_grid
from matstd.twin.frames import Array, Mask, inverse, turn
from matstd.twin.machine import table_to_tool

_LENGTH, _SAMPLES = 160.0, 8.0  # mm of the probe above its ball that are checked, in steps
_FREE_SHARE = 0.5  # of the touches on a face that must stay free beside any other face
_MAX_TOUCHES = 6  # touches per face for the comparison of pairs


def touches_on(faces: Sequence[FreeformPatch], poses: Array) -> Requests:
    """A few touches on every face."""
    return joined([each_at(p, face_grid(p.half_size, 3)[::2], poses) for p in faces])


def is_from_side(reach: ProbeReach, poses: Array) -> bool:
    """Whether the tool axis is never within 45 degrees of the standard's z."""
    up = np.tile([0.0, 0.0, 1.0], (len(poses), 1))
    at = Requests(np.full(len(poses), "FF1"), np.zeros_like(up), up, poses)
    axis = table_to_tool(reach.chain, reach.readings(at))[:, :3, 2]
    return bool((turn(inverse(reach.setup.T_table_artefact), axis)[:, 2] < np.sqrt(0.5)).all())


def untouchable_faces(reach: ProbeReach, made: Standard, poses: Array) -> list[str]:
    """Faces of a standard on which none of a few touches is possible."""
    tried = touches_on(made.patches, poses)
    tried = tried[reach.is_reachable(tried)]
    there = set(tried[reach.is_clear(made, tried)].feature.tolist())
    return [patch.name for patch in made.patches if patch.name not in there]


@dataclass(frozen=True, eq=False)
class ProbeAccess:
    """Access of the probe to F faces."""

    reached: Mask  # whether a touch is within angle and travels, (F,)
    alone: Mask  # whether such a touch clears plate, balls and the own pillar, (F,)
    beside: Mask  # whether two faces leave each other at least half of such touches, (F, F)


def mutually_probeable(
    reach: ProbeReach,
    blank: Blank,
    faces: Sequence[FreeformPatch],
    balls: Sequence[DatumSphere],
    poses: Array,
) -> ProbeAccess:
    """Access of the probe to faces, alone and in pairs, at table poses (K, R), rad."""
    tried = touches_on(faces, poses)
    tried = tried[reach.is_reachable(tried)]
    names = np.array([face.name for face in faces])
    reached = np.isin(names, tried.feature)
    tried = tried[_is_open(reach, blank, faces, balls, tried)]
    on = [np.flatnonzero(tried.feature == name) for name in names]
    alone, beside = np.array([len(rows) > 0 for rows in on]), np.diag(np.ones(len(faces)) > 0.0)
    beside &= alone
    if alone.any():
        seen = np.flatnonzero(alone)
        some = [on[k][:: -(-len(on[k]) // _MAX_TOUCHES)] for k in seen]
        owner = np.repeat(np.arange(len(seen)), [len(rows) for rows in some])
        hides = in_the_way(
            reach, blank, [faces[k] for k in seen.tolist()], tried[np.concatenate(some)]
        )
        hidden = np.array([hides[:, owner == k].mean(axis=1) for k in range(len(seen))]).T
        leaves = hidden <= 1.0 - _FREE_SHARE
        beside[np.ix_(seen, seen)] |= leaves & leaves.T
    return ProbeAccess(reached=reached, alone=alone, beside=beside)


def _is_open(
    reach: ProbeReach,
    blank: Blank,
    faces: Sequence[FreeformPatch],
    balls: Sequence[DatumSphere],
    touches: Requests,
) -> Mask:
    """Touches at which the probe clears the plate, the balls and the touched pillar."""
    ball, axis = _approach(reach, touches)
    place, radius = reach.shape.stations()
    points, least = ball[:, None] + place[:, None] * axis[:, None], radius + reach.room
    bare = with_spheres(blank, [b.centre for b in balls])
    free = np.ones(len(ball), dtype=bool)
    pillars = replace(bare, patches=tuple(faces)).columns
    for name, body in [("", body) for body in bare.bodies.values()] + list(pillars.items()):
        rows = np.flatnonzero(free & (touches.feature == name)) if name else np.flatnonzero(free)
        apart = body.distance(points[rows].reshape(-1, 3)).reshape(-1, len(place))
        free[rows] = (apart >= least).all(axis=1)
    return free


def _approach(reach: ProbeReach, touches: Requests) -> tuple[Array, Array]:
    """Centre of the probe's ball at touches, and the direction of its stylus, (N, 3) each."""
    frames = table_to_tool(reach.chain, reach.readings(touches))
    axis = turn(inverse(reach.setup.T_table_artefact), frames[:, :3, 2])
    return touches.point + reach.radius * touches.normal, axis


def in_the_way(
    reach: ProbeReach, blank: Blank, faces: Sequence[FreeformPatch], touches: Requests
) -> Mask:
    """Whether each face obstructs the probe at each touch, (F, N)."""
    ball, axis = _approach(reach, touches)
    begin, points, radii = 0.0, list[Array](), list[Array]()
    for end, radius in reach.shape.cylinders:
        for at in np.arange(begin, min(end, _LENGTH), _SAMPLES):
            points.append(ball + at * axis)
            radii.append(np.full(len(ball), radius + reach.room))
        begin = end
    where, least = np.concatenate(points), np.concatenate(radii)
    bare = replace(with_spheres(blank, []), patches=tuple(faces))
    near = [column.distance(where) < least for column in bare.columns.values()]
    return np.array([n.reshape(-1, len(ball)).any(axis=0) for n in near])
