"""Touches that prove where they show unmodelled effects best, spread over squares or balls."""

from dataclasses import replace

import numpy as np

from matstd.artefact.body import FreeformPatch, Standard
from matstd.artefact.hidden import (
    Measurement,
    Scan,
    measured_together,
    scanned,
    showing_touches,
)
from matstd.artefact.hidden import touched as single
from matstd.artefact.reach import Requests, spread_poses
from matstd.artefact.worth import Criterion
from matstd.twin.errors import NotReachable
from matstd.twin.frames import Array, IntArray, apply

SQUARE_SIDE = 40.0
"""Side of the squares of a face that get equal shares, mm: the width of the widest effect."""

PLACES_PER_TOUCH = 4.0  # places on a wavy face from which each touch is chosen
_SCAN_POSES = 3  # table poses at which a face is scanned, where the machine has several
_MOST_TRIED = 3000  # possible touches that are compared: 2 s for 150 of them


def measurement_on(
    criterion: Criterion, standard: Standard, touches: Requests, scan: Scan | None
) -> Measurement:
    """Touches, and the scan of the face where the control can."""
    lots = [single(touches, criterion.noise)]
    if scan is not None:
        some = scan_poses(touches)
        reach, faces = criterion.reach, standard.patches
        lots += [scanned(face, scan, some, reach, standard) for face in faces]
    return measured_together([lot for lot in lots if len(lot)])


def scan_poses(touches: Requests) -> Array:
    """Table poses at which a face is scanned: a few of those of the touches, (K, R), rad."""
    return spread_poses(np.unique(touches.rotary, axis=0), _SCAN_POSES)


def showing_on_body(
    criterion: Criterion,
    standard: Standard,
    tried: Requests,
    given: Measurement,
    effects_at: Array,
    count: int,
) -> Requests:
    """The touches on the one face of a standard, or its balls, that show most beside others.

    Args:
        criterion: On the standard.
        tried: Touches that can be made on the face, or on the balls.
        given: Measurements that will be made whatever is chosen.
        effects_at: Where bumps may be, readings of the linear axes, (K, 3), mm.

    Raises:
        NotReachable: Fewer than `count` places can be touched.
    """
    if len(tried) > _MOST_TRIED:
        some = np.random.default_rng(0).permutation(len(tried))[:_MOST_TRIED]
        tried = tried[np.sort(some)]
    may = single(tried, criterion.noise)
    if standard.patches:
        point, at = np.unique(tried.point, axis=0, return_inverse=True)
        if len(point) < count:
            raise NotReachable(
                f"{len(point)} places of the wavy face can be touched, {count} wanted; "
                "a smaller limits.max_slope_deg leaves the probe more room"
            )
        u = np.hypot(criterion.noise, criterion.calibration.form)
        may = replace(may, u=np.full(len(tried), u))
        at, area = at.reshape(-1), square_of(standard.patches[0], point)
    else:
        at, area = np.arange(len(tried)), np.unique(tried.feature, return_inverse=True)[1]
    return tried[showing_touches(criterion, given, may, effects_at, count, at, area)]


def square_of(face: FreeformPatch, point: Array) -> IntArray:
    """Number of the square of a face in which each of some points lies, (N,)."""
    local = apply(face.T_patch_artefact, point)[:, :2]
    half = np.array(face.half_size)
    count = np.maximum(1, np.round(2.0 * half / SQUARE_SIDE)).astype(np.int64)
    cell = np.clip(0.5 * (local / half + 1.0) * count, 0, count - 1).astype(np.int64)
    return np.asarray(np.unique(cell @ [count[1], 1], return_inverse=True)[1].reshape(-1))
