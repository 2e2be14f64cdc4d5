"""Rows that are copies of others: a measurement counted twice would get twice its weight."""

from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from matstd.twin.frames import Mask
from matstd.twin.record.run import Run
from matstd.twin.units import NM

MIN_COPIES = 8  # fewer rows that agree with an earlier one to the last digit may be chance
MIN_COPIED_SHARE = 0.6
"""Share of the repeated touches that must agree exactly: real ones rarely do, unless readings are
much coarser than the noise."""
COPY_READING = 0.05
"""Touches whose readings lie within this (mm, or mrad) at one calibrated point are repeated."""


ROWS_PER_VALUE = 8
"""With more rows per distinct deviation the reading is coarse; a file is rarely copied into itself
more often."""


def without_copies(run: Run) -> Run:
    """The run without copied rows, with a remark; the run itself if there are none.

    A row that occurs twice, its time included, is a copy; without times only if more rows do than
    the resolution of the reading explains by chance. Rows that agree with earlier ones in all
    columns but the time are copies if most repeated touches do, since the noise of real ones
    differs. Rows of another repetition or feature are never copies.

    Example:
        A file that was pasted twice under itself counts once.
    """
    out, remarks = run, list(run.remarks)
    same = _copies(run, with_time=True)
    chance = 0.0 if np.ptp(run.touches.time) > 0.0 else 3.0 * _by_chance(run)
    if same.any() and same.sum() > chance:
        out = out[~same]
        remarks.append(_words(run, same, "stand twice" if same.sum() > 1 else "stands twice"))
    again = _copies(out, with_time=False)
    # touches that were made before at nearly the same readings
    repeated = int(_later(_places(out)).sum())
    is_odd = again.sum() >= MIN_COPIES and again.sum() > MIN_COPIED_SHARE * repeated
    # deviations may be read in steps so large that equal ones mean nothing
    is_coarse = len(np.unique(out.deviation)) * ROWS_PER_VALUE < len(out)
    if is_odd and not is_coarse:
        remarks.append(
            _words(out, again, "repeat the readings and the deviation of earlier rows exactly")
        )
        out = out[~again]
    return replace(out, remarks=tuple(remarks)) if out is not run else run


def _copies(run: Run, with_time: bool) -> Mask:
    """Rows that agree with an earlier one in everything measured, (N,)."""
    t = run.touches
    recorded = [*t.temperature.values(), *t.value.values()]
    recorded += [v for v in (t.spindle_rpm, t.force) if v is not None]
    labels = [np.unique(t.feature, return_inverse=True)[1].reshape(-1), t.pose, t.setup]
    labels += [run.repeat] if run.repeat is not None else []
    key = [t.q, t.point, t.normal, t.approach, *labels, *recorded, run.deviation]
    return _later(np.column_stack([*key, t.time] if with_time else key))


def _places(run: Run) -> NDArray[np.float64]:
    """Equal rows for touches at one point with nearly the same readings, (N, K)."""
    t = run.touches
    kinds = [t.chain.link(axis).kind for axis in t.chain.axes]
    scale = COPY_READING * np.array([1.0 if kind == "linear" else 1e-3 for kind in kinds])
    return np.column_stack([np.round(t.q / scale), np.round(t.point / NM), t.setup])


def _by_chance(run: Run) -> float:
    """Expected number of deviations that agree with an earlier one of the same touch.

    Of m that fall evenly into n steps of the reading, ``m - n (1 - (1 - 1/n)^m)`` fall where one
    is already; a normal spread of standard deviation u is as wide as ``2 sqrt(pi) u`` of even ones.
    """
    levels = np.unique(run.deviation)
    if len(levels) < 2:
        return 0.0  # steps of the reading do not show
    step = float(np.diff(levels).min())
    n = max(2.0 * np.sqrt(np.pi) * float(np.median(run.u)) / step, 1.0)
    m = np.unique(_places(run), axis=0, return_counts=True)[1]
    return float(np.sum(m - n * (1.0 - (1.0 - 1.0 / n) ** m)))


def _later(key: NDArray[np.float64]) -> Mask:
    """Rows of a table that equal an earlier row, (N,)."""
    first = np.unique(key, axis=0, return_index=True)[1]
    later = np.ones(len(key), dtype=bool)
    later[first] = False
    return later


def _words(run: Run, copies: Mask, what: str) -> str:
    count = int(copies.sum())
    rows = "row" if count == 1 else "rows"
    line = int(run.line[np.argmax(copies)])
    return f"line {line}: {count} {rows} {what}; copies are left out, each touch counts once"
