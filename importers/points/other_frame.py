"""Point lists measured in another frame than the drawing's: turned or shifted by any amount.

A CMM has its own origin, and a plate may lie anywhere on a table. The rigid motion that fits
nominal to measured points has a closed form for any size, in one to three directions. Outliers are
left out by repeating the fit; a mirrored fit that is far better reveals an axis that counts the
other way.
"""

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace

import numpy as np

from matstd.importers.points.point_list import PointList
from matstd.twin.errors import DesignError
from matstd.twin.frames import Array, apply, inverse
from matstd.twin.numbers import rms
from matstd.twin.record import rigid_motion, turn_of

SHIFT = 1.0
"""A larger displacement (mm) is another frame; a smaller one is found by the linear fit of the
set-up."""
TURN = 1e-3
"""A larger rotation (rad) is another frame: half its square times 200 mm is 0.1 µm, the error of
the linear fit of the set-up."""
OFF_FRAME_RATIO = 5.0
"""Points farther off than this multiple of the median are outliers and left out of the fit."""
MAX_FRAME_ROUNDS = 20  # repetitions of the choice of near points; two are usual
MIRROR_RATIO = 10.0
"""A mirrored frame must fit better by this factor before an axis counts as reversed."""


@dataclass(frozen=True, eq=False)
class OtherFrame:
    """Where the points of one set-up were measured."""

    setup: str
    T: Array  # takes nominal places to measured ones, (4, 4), mm
    shift: float  # how far the middle of the points was moved, mm
    turn: float  # by which angle they were turned, rad

    @property
    def is_far(self) -> bool:
        """Whether it is too far from the nominal frame for a linear fit of the set-up."""
        return self.turn > TURN or self.shift > SHIFT


def measured_frames(points: PointList) -> list[OtherFrame]:
    """Frames of set-ups whose points determine them; raises DesignError for a mirrored one."""
    out = []
    for setup in dict.fromkeys(points.setup.tolist()):
        rows = points.setup == setup
        off = points.deviation[rows]
        measured = np.isfinite(off).any(axis=0)
        whole = np.isfinite(off[:, measured]).all(axis=1)
        if whole.sum() <= measured.sum():
            continue
        a = points.nominal[rows][whole][:, measured]
        T = np.eye(4)
        letters = [*np.flatnonzero(measured), 3]
        T[np.ix_(letters, letters)] = _motion(setup, a, a + off[whole][:, measured])
        middle = points.nominal[rows][whole].mean(axis=0)
        shift = float(np.linalg.norm(apply(T, middle) - middle))
        out.append(OtherFrame(setup, T, shift, float(turn_of(T[:3, :3]))))
    return out


def in_nominal_frame(points: PointList, frames: Sequence[OtherFrame]) -> PointList:
    """The same list with what was measured brought back to the frame of the nominal places.

    A point without all three coordinates cannot be rotated: it counts as not measured.
    """
    return _moved(points, frames, lambda T, nominal, found: apply(inverse(T), found) - nominal)


def in_measured_frame(points: PointList, frames: Sequence[OtherFrame]) -> PointList:
    """The same list with deviations from where the nominal places lie in the measured frame."""
    return _moved(points, frames, lambda T, nominal, found: found - apply(T, nominal))


def places(points: PointList, frames: Sequence[OtherFrame]) -> Array:
    """Nominal places in the frame in which they were measured, (N, 3), mm."""
    out = points.nominal.copy()
    for frame in frames:
        rows = points.setup == frame.setup
        out[rows] = apply(frame.T, points.nominal[rows])
    return out


def _moved(
    points: PointList,
    frames: Sequence[OtherFrame],
    deviation_of: Callable[[Array, Array, Array], Array],
) -> PointList:
    """A list with deviations computed from a frame, the nominal places and those found."""
    deviation = points.deviation.copy()
    for frame in frames:
        rows = np.flatnonzero(points.setup == frame.setup)
        nominal, off = points.nominal[rows], points.deviation[rows]
        measured = np.isfinite(off).any(axis=0)
        found = np.where(measured, nominal + off, apply(frame.T, nominal))
        deviation[rows] = np.where(measured, deviation_of(frame.T, nominal, found), np.nan)
    return replace(points, deviation=deviation)


def _motion(setup: str, a: Array, b: Array) -> Array:
    """Pose (k + 1, k + 1) that takes a to b in k directions, without outliers."""
    near = np.ones(len(a), dtype=bool)
    for _ in range(MAX_FRAME_ROUNDS):
        T = rigid_motion(a[near], b[near])
        off = np.linalg.norm(_at(T, a) - b, axis=1)
        kept = off <= max(OFF_FRAME_RATIO * float(np.median(off)), 1e-9)
        if np.array_equal(kept, near):
            break
        near = kept
    mirrored = rigid_motion(a[near], b[near], is_mirrored=True)
    left, other = (rms(_at(M, a[near]) - b[near]) for M in (T, mirrored))
    if a.shape[1] > 1 and left > SHIFT and left > MIRROR_RATIO * other and _fills(a):
        raise DesignError(
            f"points of {setup!r}: they fit a mirrored frame to {other:.3g} mm rms and no other "
            f"({left:.3g} mm); expected axes that count the same way as the nominal ones"
        )
    return T


def _at(T: Array, a: Array) -> Array:
    """Points after a pose in their k directions."""
    return np.asarray(a @ T[:-1, :-1].T + T[:-1, -1])


def _fills(a: Array) -> bool:
    """Whether points spread in all directions, so that a mirrored frame is another one."""
    s = np.linalg.svd(a - a.mean(axis=0), compute_uv=False)
    return len(s) == a.shape[1] and bool(s[-1] > SHIFT)
