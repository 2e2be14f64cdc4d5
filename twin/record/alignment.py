"""Set-ups that stand elsewhere than their file says, found before anything is linear.

Every touch gives a pair of points: the centre of the ball on the calibrated surface, artefact
frame, and the tool point of the nominal machine, table frame. The rigid motion that joins the
pairs best is known in closed form at any size; machine errors are small beside what makes it
necessary.

Reference:
    W. Kabsch, Acta Cryst. A32 (1976) 922: rotation between two sets of points.
"""

from dataclasses import dataclass, replace

import numpy as np

from matstd.twin.frames import Array, apply, pose
from matstd.twin.machine import tip
from matstd.twin.record.run import Run
from matstd.twin.record.touches import Touches, computed_deviation

SHIFT = 0.3
"""Displacement (mm) from which a set-up is moved: lever arms off by so much turn 50 µrad of a
rotary axis into 0.015 µm, which no touch notices."""

TURN = 1e-3
"""Rotation (rad) from which it is moved: half its square times 200 mm is 0.1 µm, what a linear fit
of the set-up would get wrong."""

FEWEST = 6
"""Touches of a set-up, one for each of its freedoms; of fewer nothing is concluded."""

SLIP = 10.0
"""Touches farther off than so many times the median are slips and do not count."""

FLAT = 1.0
"""Touches that spread by less (mm) in a direction do not tell a rotation: it is left as stated."""


@dataclass(frozen=True)
class Moved:
    """A set-up that was moved.

    Attributes:
        name: Of the set-up.
        shift: Displacement of the middle of its touches, mm.
        turn: Angle of its rotation, rad.
    """

    name: str
    shift: float
    turn: float


def aligned(run: Run) -> tuple[Run, tuple[Moved, ...]]:
    """A run whose set-ups stand where its touches say, and which of them were moved.

    Deviations are computed anew from the readings; call it only where they were computed so.

    Args:
        run: Measurements of a touching ball, or of any instrument that states points.
    """
    t = run.touches
    centre = t.point + t.radius[:, None] * t.normal
    reached = tip(t.chain, t.q, t.target)
    setups, moved = list(t.setups), []
    for i, setup in enumerate(t.setups):
        rows = t.setup == i
        if rows.sum() < FEWEST:
            continue
        a, b, stated = centre[rows], reached[rows], setup.T_table_artefact
        T = rigid_motion(a, b, stated)
        far = np.linalg.norm(apply(T, a) - b, axis=1)
        near = far <= SLIP * np.median(far)  # a slip of the pen must not turn the standard
        T = rigid_motion(a[near], b[near], stated)
        middle = centre[rows].mean(axis=0)
        change = apply(T, middle) - apply(setup.T_table_artefact, middle)
        R = T[:3, :3] @ setup.T_table_artefact[:3, :3].T
        shift = float(np.linalg.norm(change))
        turn = float(np.arccos(np.clip(0.5 * (np.trace(R) - 1.0), -1.0, 1.0)))
        if shift > SHIFT or turn > TURN:
            setups[i] = replace(setup, T_table_artefact=T)
            moved.append(Moved(setup.name, shift, turn))
    if not moved:
        return run, ()
    touches: Touches = replace(t, setups=tuple(setups))
    return replace(run, touches=touches, deviation=computed_deviation(touches)), tuple(moved)


def rigid_motion(a: Array, b: Array, stated: Array, flat: float = FLAT) -> Array:
    """Pose that takes points a to points b best, (4, 4).

    Points on a line, across which they spread by less than `flat`, do not turn what is stated.
    """
    middle_a, middle_b = a.mean(axis=0), b.mean(axis=0)
    told = (a - middle_a) @ stated[:3, :3].T
    U, s, Vt = np.linalg.svd(told.T @ (b - middle_b))
    spread = np.sqrt(s / len(a))
    if spread[1] < flat:  # touches on a line: a rotation about it is anybody's guess
        R = np.eye(3)
    else:
        sign = np.sign(np.linalg.det(Vt.T @ U.T))
        R = Vt.T @ np.diag([1.0, 1.0, sign]) @ U.T
    R = R @ stated[:3, :3]
    return pose(R, middle_b - R @ middle_a)
