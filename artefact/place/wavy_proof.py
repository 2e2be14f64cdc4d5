"""Touches and table poses that prove where they show unmodelled effects best."""

from dataclasses import replace

import numpy as np

from matstd.artefact.body import FreeformPatch, Standard
from matstd.artefact.hidden import (
    Measurement,
    Scan,
    measured_together,
    scanned,
    showing_poses,
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
SCAN_POSES = 3  # table poses at which a face is scanned, where the machine has several
_TRIED_POSES = 10  # table poses of which those that show most are chosen
_TRIED_SCAN = Scan(between=16.0)  # by which they are compared: a quarter of the means of a scan
_MOST_TRIED = 3000  # possible touches that are compared: 2 s for 150 of them


def measurement_on(
    criterion: Criterion, standard: Standard, touches: Requests, scan: Scan | None, at: Array
) -> Measurement:
    """Touches, and the scan of the face at some table poses (K, R), rad, where the control can."""
    lots = [single(touches, criterion.noise)]
    if scan is not None:
        lots += [scanned(face, scan, at, criterion.reach, standard) for face in standard.patches]
    return measured_together([lot for lot in lots if len(lot)])


def showing_table_poses(
    criterion: Criterion,
    standard: Standard,
    given: Measurement,
    poses: Array,
    effects_at: Array,
    count: int,
) -> Array:
    """Table poses at which a scan of the one face of a standard shows most, the best first.

    Where the table is tilted, the probe has room at few places of a face. Poses with less than half
    the places of the best one are left out.

    Args:
        criterion: On the standard.
        given: Measurements that will be made whatever is chosen.
        poses: To choose from, (K, R), rad.
        effects_at: Where bumps may be, readings of the linear axes, (K, 3), mm.
    """
    if len(poses) < 2:
        return poses
    (face,), reach = standard.patches, criterion.reach
    scans = {tuple(p): scanned(face, _TRIED_SCAN, p[None], reach, standard) for p in poses}
    most = max(map(len, scans.values()))
    roomy = np.array([pose for pose, lot in scans.items() if 2 * len(lot) >= most])
    tried = spread_poses(roomy, _TRIED_POSES)
    lots = [scans[tuple(pose)] for pose in tried]
    return tried[showing_poses(criterion, given, lots, effects_at, count)]


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
        at, area = at.ravel(), square_of(standard.patches[0], point)
    else:
        at, area = np.arange(len(tried)), np.unique(tried.feature, return_inverse=True)[1]
    return tried[showing_touches(criterion, given, may, effects_at, count, at, area)]


def square_of(face: FreeformPatch, point: Array) -> IntArray:
    """Number of the square of a face in which each of some points lies, (N,)."""
    local = apply(face.T_patch_artefact, point)[:, :2]
    half = np.array(face.half_size)
    count = np.maximum(1, np.round(2.0 * half / SQUARE_SIDE)).astype(np.int64)
    cell = np.clip(0.5 * (local / half + 1.0) * count, 0, count - 1).astype(np.int64)
    return np.asarray(np.unique(cell @ [count[1], 1], return_inverse=True)[1].ravel())
