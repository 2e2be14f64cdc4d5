"""Where a machine was sent, of touches whose readings hold what was measured.

A touch trigger stops the axes at the surface: the reading is the commanded one plus the deviation,
with its noise. A residual regressed on it correlates with itself: on a flat plate touched along Z,
where Z varies by nothing else, pure noise "varies with Z".
"""

from dataclasses import replace

import numpy as np

from matstd.twin.frames import Array
from matstd.twin.machine import linear_directions
from matstd.twin.record.run import Run
from matstd.twin.record.touches import Touches, computed_deviation

FAR_MOVED = 2000.0
"""Range of an axis over usual deviations from which its readings stay as they are: noise is then
small beside every period that is looked for. Errors are functions of the true reading; one of
0.4 mm shifts the argument of its own wave, which over commanded readings looks like an overtone.
"""

LARGE = 0.05
"""Usual deviation (mm) from which they stay as they are whatever the range."""

FEW = 1 / 8
"""Levels over touches up to which an axis has moved by little but what was measured."""

FAR = 10.0
"""Deviations beyond so many times the median do not place a set-up."""


def with_commanded(run: Run) -> Run:
    """The run with the readings at which its touches were expected (`Touches.commanded`).

    ``q - D+ n r`` with D the directions of the linear axes, n the normal and r the deviation less
    the rigid motion of each set-up that fits it best: a set-up that stands elsewhere is met where
    it stands. Readings of instruments beside the machine are commanded as they are; a row counts
    as such where its readings imply less than half of its deviation. Only axes are given so that
    moved little (`FAR_MOVED`) or stood at few places, as Z of a flat plate.
    """
    touches = run.touches
    is_ball = touches.instrument.is_ball_on_standard & (touches.radius > 0.0)
    implied = computed_deviation(touches)
    holds = is_ball & (np.abs(implied) >= 0.5 * np.abs(run.deviation))
    residual = np.where(holds, _less_setups(touches, implied), 0.0)
    if not residual.any():
        return run
    linear = [touches.chain.axis_index(axis) for axis in touches.chain.linear_axes]
    directions = linear_directions(touches.chain, touches.q)  # (N, 3, axes)
    step = np.linalg.pinv(directions) @ touches.normal_table[:, :, None]
    moved = step[:, :, 0] * residual[:, None]
    commanded = touches.q.copy()
    for column, by in zip(linear, moved.T, strict=True):
        usual = float(np.median(np.abs(by)))
        at = touches.q[:, column] - by
        is_near = usual < LARGE and np.ptp(at) < FAR_MOVED * usual
        if is_near or _levels(at, 2.0 * usual) < FEW * len(at):
            commanded[:, column] = at
    return replace(run, touches=replace(touches, commanded=commanded))


def _levels(values: Array, apart: float) -> int:
    """Number of places that values apart by so much stand at."""
    return len(np.unique(np.round(values / apart))) if apart > 0.0 else len(values)


def _less_setups(touches: Touches, deviation: Array) -> Array:
    """Deviations less the rigid motion of each set-up that fits its usual touches best, (N,)."""
    out = deviation.copy()
    arms = np.cross(touches.point - touches.point.mean(axis=0), touches.normal)
    modes = np.column_stack([touches.normal, arms])
    for number in range(len(touches.setups)):
        rows = np.flatnonzero(touches.setup == number)
        usual = rows
        if not len(rows):
            continue
        for _ in range(2):  # a slip must not turn the standard
            size = np.linalg.lstsq(modes[usual], deviation[usual], rcond=1e-9)[0]
            off = np.abs(deviation[rows] - modes[rows] @ size)
            usual = rows[off <= FAR * max(float(np.median(off)), 1e-12)]
        out[rows] -= modes[rows] @ size
    return out
