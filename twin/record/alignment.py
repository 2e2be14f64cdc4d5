"""Set-ups that stand elsewhere than the file states, found before linearisation.

Every touch gives a pair of points: the centre of the ball on the calibrated surface, artefact
frame, and the tool point of the nominal machine, table frame. The rigid motion that fits the pairs
best has a closed form for any size (SVD); machine errors are small compared with the displacements
that make it necessary.

Reference:
    W. Kabsch, Acta Cryst. A32 (1976) 922: rotation between two sets of points.
"""

from dataclasses import replace

import numpy as np

from matstd.twin.frames import Array, apply, rotation_vector
from matstd.twin.machine import tip
from matstd.twin.record.run import Moved, Run
from matstd.twin.record.touches import Touches, computed_deviation

SHIFT = 0.3
"""Displacement (mm) from which a set-up is moved: lever arms off by so much turn 50 µrad of a
rotary axis into 0.015 µm, which no touch notices."""
TURN = 1e-3
"""Rotation (rad) from which it is moved: half its square times 200 mm is 0.1 µm, what a linear fit
of the set-up would get wrong."""
MIN_ALIGNED_TOUCHES = 6
"""Touches of a set-up, one for each degree of freedom; with fewer the set-up stays as stated."""
MISALIGNED_RATIO = 10.0
"""Touches farther off than this multiple of the median are outliers and not used."""
MIN_SPREAD = 1.0
"""Touches that spread less (mm) in a direction do not determine a rotation; it stays as stated."""


def aligned(run: Run) -> tuple[Run, tuple[Moved, ...]]:
    """A run with its set-ups moved to where the touches show them, and the list of moved ones.

    Deviations are recomputed from the readings; call it only for runs that compute them so: of a
    touching ball, or of any instrument that states points.
    """
    t = run.touches
    centre = t.point + t.radius[:, None] * t.normal
    reached = tip(t.chain, t.q, t.target)
    setups, moved = list(t.setups), []
    for i, setup in enumerate(t.setups):
        rows = t.setup == i
        if rows.sum() < MIN_ALIGNED_TOUCHES:
            continue
        a, b, stated = centre[rows], reached[rows], setup.T_table_artefact
        T = rigid_motion(a, b, stated)
        far = np.linalg.norm(apply(T, a) - b, axis=1)
        near = far <= MISALIGNED_RATIO * np.median(far)  # an outlier must not turn the standard
        T = rigid_motion(a[near], b[near], stated)
        middle = centre[rows].mean(axis=0)
        change = apply(T, middle) - apply(setup.T_table_artefact, middle)
        R = T[:3, :3] @ setup.T_table_artefact[:3, :3].T
        shift = float(np.linalg.norm(change))
        turn = float(turn_of(R))
        if shift > SHIFT or turn > TURN:
            setups[i] = replace(setup, T_table_artefact=T)
            origin = T[:3, 3] - setup.T_table_artefact[:3, 3]
            moved.append(
                Moved(
                    name=setup.name,
                    shift=shift,
                    turn=turn,
                    turned=rotation_vector(R),
                    origin=origin,
                )
            )
    if not moved:
        return run, ()
    touches: Touches = replace(t, setups=tuple(setups))
    placed = replace(run, touches=touches, deviation=computed_deviation(touches))
    return replace(placed, moved=tuple(moved)), tuple(moved)


def rigid_motion(
    a: Array,
    b: Array,
    stated: Array | None = None,
    flat: float = MIN_SPREAD,
    is_mirrored: bool = False,
) -> Array:
    """Pose that takes points a to points b best, (k + 1, k + 1) in k directions.

    Args:
        a: Points, (N, k), mm.
        b: Where they are found, (N, k), mm.
        stated: Pose whose rotation is kept where points lie on a line, across which they spread by
            less than `flat`; None stands for no rotation.
        flat: Spread, mm.
        is_mirrored: Whether the rotation has a reflection in it.
    """
    k = a.shape[1]
    R = np.eye(k) if stated is None else stated[:k, :k]
    middle_a, middle_b = a.mean(axis=0), b.mean(axis=0)
    U, s, Vt = np.linalg.svd(R @ (a - middle_a).T @ (b - middle_b))
    # points on a line do not determine the rotation about it
    if is_mirrored or k == 1 or np.sqrt(s[-2] / len(a)) >= flat:
        sign = np.sign(np.linalg.det(Vt.T @ U.T)) * (-1.0 if is_mirrored else 1.0)
        R = Vt.T @ np.diag([*np.ones(k - 1), sign]) @ U.T @ R
    T = np.eye(k + 1)
    T[:k, :k], T[:k, k] = R, middle_b - R @ middle_a
    return T


def turn_of(R: Array) -> Array:
    """Angles of rotations (..., 3, 3), rad."""
    trace = np.trace(R, axis1=-2, axis2=-1)
    return np.asarray(np.arccos(np.clip(0.5 * (trace - 1.0), -1.0, 1.0)))
