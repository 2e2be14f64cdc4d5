"""Logs of one axis: strokes and directions out of its readings, temperatures beside them."""

import re

import numpy as np

from matstd.importers.sheets import SECONDS, Sheet, unit_of_column
from matstd.twin.frames import Array
from matstd.twin.record import IntArray

_LOAD = re.compile(r"\AF_?([xyz])[\s_]*[\[(_]\s*N[\])]?\s*\Z", re.IGNORECASE)
_OWN = re.compile(r"(.+?)[\s_]*[\[(]\s*([^\])]+?)\s*[\])]\s*\Z")
_DEGREES = re.compile(r"[\[(_\s]*(°C|degC|deg C)[\])]?\s*\Z")


def strokes(at: Array) -> tuple[IntArray, IntArray]:
    """Sign of the last motion at every row of a log, and the number of its stroke, (N,) each.

    A reading that has not changed belongs to the stroke that brought it there; before the first
    motion the sign is 0.

    Args:
        at: Readings in the order in which they were taken, (N,).

    Example:
        >>> strokes(np.array([0.0, 1.0, 1.0, 2.0, 1.0]))
        (array([ 0,  1,  1,  1, -1]), array([1, 1, 1, 1, 2]))
    """
    step = np.sign(np.diff(at, prepend=at[:1]))
    last = np.maximum.accumulate(np.where(step != 0.0, np.arange(len(at)), 0))
    sign = step[last].astype(np.int64)
    turned = np.zeros(len(at), dtype=bool)
    turned[1:] = sign[1:] * sign[:-1] < 0
    return sign, 1 + np.cumsum(turned)


def approaches(at: Array) -> tuple[IntArray, IntArray]:
    """Directions of approach and cycles of a positioning test, (N,) each, by the order of its rows.

    A target was reached from the one before it; of one that stands twice where the motion turns,
    the second belongs to the way back. A step over more than half the travel begins a new cycle,
    and so does every second turn. All signs are 0 where most rows repeat the one before: no order
    is told by them.

    Args:
        at: Targets in the order in which they stand, (N,).

    Example:
        >>> approaches(np.array([0.0, 1.0, 2.0, 2.0, 1.0, 0.0, 0.0, 1.0]))
        (array([ 1,  1,  1, -1, -1, -1,  1,  1]), array([1, 1, 1, 1, 1, 1, 2, 2]))
    """
    n = len(at)
    step = np.diff(at)
    if n < 3 or np.mean(step == 0.0) > 0.5 or not np.all(np.isfinite(at)):
        return np.zeros(n, dtype=np.int64), np.ones(n, dtype=np.int64)
    before, after = np.r_[0.0, step], np.r_[step, 0.0]
    usual = 1.5 * np.median(np.abs(step[step != 0.0]))
    is_back = np.abs(before) > max(0.5 * np.ptp(at), usual)
    sign = np.sign(np.where((before == 0.0) | is_back, after, before)).astype(np.int64)
    turns = (sign[1:] * sign[:-1] < 0) & ~is_back[1:]
    strokes_before = np.r_[0, np.cumsum(turns)]
    return sign, 1 + strokes_before // 2 + np.cumsum(is_back)


def temperatures(sheet: Sheet) -> dict[str, Array]:
    """Columns of temperatures by the name of the sensor, each (N,), degC."""
    out = {}
    for i, column in enumerate(sheet.columns):
        match = _DEGREES.search(column)
        if match:
            name = re.sub(r"\W+", "_", column[: match.start()]).strip("_") or f"column{i + 1}"
            out[name.removeprefix("T_")] = sheet.numbers(i)
    return out


def loads(sheet: Sheet) -> Array | None:
    """Load on the tool, (N, 3), N, of columns `Fx [N]`; None where there are none."""
    found = {m[1].lower(): i for i, c in enumerate(sheet.columns) if (m := _LOAD.match(c))}
    if not found:
        return None
    zero = np.zeros(len(sheet))
    return np.stack([sheet.numbers(found[c]) if c in found else zero for c in "xyz"], axis=1)


def own_columns(sheet: Sheet) -> dict[str, Array]:
    """Whole columns with another unit than a length's, an angle's or a time's, `tau2 [Nm]`, (N,).

    By name and unit as a run has them (`tau2_Nm`); they may drive any effect.
    """
    out = {}
    for i, column in enumerate(sheet.columns):
        match = _OWN.match(column)
        if i in sheet.used or match is None or unit_of_column(column) or match[2] in SECONDS:
            continue
        if _DEGREES.search(column) or _LOAD.match(column):
            continue
        cells = [row[i] for row in sheet.cells]
        if all(isinstance(cell, float) for cell in cells):
            name, unit = (re.sub(r"\W+", "_", part).strip("_") for part in match.groups())
            if name and unit:
                out[f"{name}_{unit}"] = sheet.numbers(i)
    return out
