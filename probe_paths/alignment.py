"""Where each ball really met the surface: every table pose is aligned by itself.

A machine whose errors carry the ball a quarter of a millimetre along the surface touches it beside
the foot point of where the ball was believed to be, and the curvature in between, some
micrometres, would pass for a deviation. Within one table pose most of that error is one rigid
motion, so it is fitted and the foot points are taken of the balls so moved. The deviations stay
those of the believed balls: only the point and the normal that they refer to are better.
"""

import numpy as np

from artefact.standard import Standard
from probe_paths.feet import foot_points
from twin.frames import Array
from twin.touches import IntArray, Labels

SPREAD = 0.3
"""Expected size of the rigid motion of a pose, mm at the distance of the balls; it keeps directions
that few touches see from running away."""

_NOISE = 0.02
"""How closely a pose is asked to fit, mm: errors along X, Y and Z vary by this much between the
touches of one pose, and a motion that follows them would slide along what the touches see badly."""

_ARM = 100.0  # mm; scales rotations to lengths
_ROUNDS = 8
_STILL = 1e-6  # mm


def aligned_feet(
    standard: Standard, feature: Labels, ball: Array, pose: IntArray, radius: float
) -> tuple[Array, Array]:
    """Foot points and normals of balls after every pose was aligned with the standard.

    Moving the balls of a pose by (e, r) about their middle c changes their deviations by
    ``n . e + ((x - c) x n) . r``; a ridge of `SPREAD` decides what the touches leave open.

    Args:
        standard: As calibrated.
        feature: Touched features, (N,).
        ball: Believed ball centres in the artefact frame, (N, 3), mm.
        pose: Label of the table pose, (N,).
        radius: Of the ball, mm.

    Returns:
        Points and outward normals, (N, 3) each, artefact frame; nan without a foot point.
    """
    moved = ball.copy()
    for label in np.unique(pose):
        rows = np.flatnonzero(pose == label)
        moved[rows] = _aligned(standard, feature[rows], ball[rows], radius)
    return foot_points(standard, feature, moved)


def _aligned(standard: Standard, feature: Labels, ball: Array, radius: float) -> Array:
    """Balls of one pose, moved as a rigid body to where they touch best, (M, 3)."""
    moved, middle = ball.copy(), ball.mean(axis=0)
    total = np.zeros(6)
    for _ in range(_ROUNDS):
        point, normal = foot_points(standard, feature, moved)
        if not np.all(np.isfinite(point)):
            return ball
        deviation = np.einsum("ni,ni->n", normal, moved - point) - radius
        arm = (moved - middle) / _ARM
        A = np.concatenate([normal, np.cross(arm, normal)], axis=1) / _NOISE
        right = -A.T @ deviation / _NOISE - total / SPREAD**2
        step = np.linalg.solve(A.T @ A + np.eye(6) / SPREAD**2, right)
        total += step
        moved = moved + step[:3] + np.cross(step[3:], arm)
        if np.abs(step).max() < _STILL:
            break
    return moved
