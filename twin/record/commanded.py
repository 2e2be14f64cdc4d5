"""Where a machine was sent, of touches whose readings hold what was measured.

A touch trigger stops the axes at the surface: the reading is the commanded one plus the deviation,
with its noise. A residual regressed on it correlates with itself: on a flat plate touched along Z,
where Z varies by nothing else, pure noise "varies with Z".
"""

from dataclasses import replace

import numpy as np

from twin.frames import Array
from twin.machine import linear_directions
from twin.record.run import Run
from twin.record.touches import Touches, computed_deviation

FEW = 1 / 8
"""Levels over touches from which an axis is taken to have moved by itself, not by what was
measured. Errors are functions of the true reading: one of 450 µm shifts the argument of its own
wave, which on commanded readings looks like an overtone."""

FAR = 10.0
"""Deviations beyond so many times the median do not place a set-up."""


def with_commanded(run: Run) -> Run:
    """The run with the readings at which its touches were expected (`Touches.commanded`).

    Axes are given so that stood at few places but for what was measured, as Z of a flat plate:
    ``q - D+ n r`` with D the directions of the linear axes, n the normal and r the deviation less
    the rigid motion of each set-up that fits it best: a set-up that stands elsewhere is met where
    it stands. Readings of instruments beside the machine are commanded as they are; a row counts
    as such where its readings imply less than half of its deviation.
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
        size = 2.0 * float(np.median(np.abs(by)))
        at = touches.q[:, column] - by
        if size > 0.0 and len(np.unique(np.round(at / size))) < FEW * len(at):
            commanded[:, column] = at
    return replace(run, touches=replace(touches, commanded=commanded))


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
