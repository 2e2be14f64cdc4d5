"""Commanded readings of touches whose recorded readings hold the measured value.

A touch trigger stops the axes at the surface: the reading is the commanded one plus the deviation,
with its noise. A residual regressed on it correlates with itself: on a flat plate touched along Z,
pure noise would "vary with Z". So the deviation, less the motion of its set-up, is subtracted along
the normal.
"""

from dataclasses import replace

import numpy as np

from matstd.twin.frames import Array
from matstd.twin.machine import linear_motion
from matstd.twin.record.run import Run
from matstd.twin.record.touches import Instrument, Touches, computed_deviation

MIN_RANGE_RATIO = 2000.0
"""From this ratio of an axis's range to the median deviation its readings are kept: noise is then
small against every period searched for. Errors are functions of the true reading; an error of 0.4
mm shifts the argument of its own wave, which over commanded readings looks like an overtone.
"""
LARGEST_DEVIATION = 0.05  # from this median deviation (mm) readings are kept, whatever the range
MAX_LEVEL_SHARE = 1 / 8
"""Up to this ratio of levels to touches an axis moved by little more than the measured
deviation."""
OUTLIER_RATIO = 10.0  # deviations beyond this multiple of the median are not used to place a set-up


def with_commanded(run: Run) -> Run:
    """The run with the readings at which its touches were expected (`Touches.commanded`).

    ``q - D+ n r`` with D the directions of the linear axes, n the normal and r the deviation less
    the rigid motion of each set-up that fits it best: a set-up that stands elsewhere is met where
    it stands. Readings of instruments beside the machine are commanded as they are; a row counts
    as such where its readings imply less than half of its deviation. Only axes are given so that
    moved little (`MIN_RANGE_RATIO`) or stood at few places, as Z of a flat plate.
    """
    touches = run.touches
    if not touches.instrument.reads_by_the_axes:
        return run
    implied = computed_deviation(touches)
    is_moved = (touches.radius > 0.0) | (touches.instrument is Instrument.DIAL_GAUGE)
    holds = is_moved & (np.abs(implied) >= 0.5 * np.abs(run.deviation))
    residual = np.where(holds, _less_setups(touches, implied), 0.0)
    if not residual.any():
        return run
    moved = linear_motion(touches.chain, touches.q, residual[:, None] * touches.normal_table)
    commanded = touches.q.copy()
    for column in touches.chain.linear_columns:
        by = moved[:, column]
        usual = float(np.median(np.abs(by)))
        at = touches.q[:, column] - by
        is_near = usual < LARGEST_DEVIATION and np.ptp(at) < MIN_RANGE_RATIO * usual
        places = len(np.unique(np.round(at / (2.0 * usual)))) if usual > 0.0 else len(at)
        if is_near or places < MAX_LEVEL_SHARE * len(at):
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
        for _ in range(2):  # an outlier must not turn the standard
            size = np.linalg.lstsq(modes[usual], deviation[usual], rcond=1e-9)[0]
            off = np.abs(deviation[rows] - modes[rows] @ size)
            usual = rows[off <= OUTLIER_RATIO * max(float(np.median(off)), 1e-12)]
        out[rows] -= modes[rows] @ size
    return out
