"""Directions of approach, from words of a table or from the order of its rows."""

import re

import numpy as np

from matstd.importers.sheets.sheet import Sheet
from matstd.twin.frames import Array, IntArray

_DOWN = re.compile(
    r"down|\bdn\b|dwn|↓|-|−|\bneg|\brev|\bb(ack|wd|kw)|rück|ruck|zur|\bret", re.IGNORECASE
)
_UP = re.compile(
    r"\bup|↑|\+|\bpos(itive?)?\b|\bf(wd|or)|\bvor|\bhin\b|\baller|montée|croiss", re.IGNORECASE
)


def sign_of(words: str) -> int:
    """1 for words such as up or forward, -1 for down or back, 0 for others."""
    return 1 if _UP.search(words) else -1 if _DOWN.search(words) else 0


def signs(sheet: Sheet, column: int) -> IntArray:
    """Signs of directions of approach in a column, (N,), 0 for none; raises BadFile for others."""
    out = np.zeros(len(sheet), dtype=np.int64)
    for i, word in enumerate(sheet.text(column)):
        out[i] = int(word) if word in ("1", "-1", "0") else sign_of(word)
        if word not in ("", "0") and not out[i]:
            raise sheet.bad(i, column, repr(word), "up or down (+ or -, 1 or -1)")
    return out


def strokes(at: Array) -> tuple[IntArray, IntArray]:
    """Sign of the last motion at every row of a log, and the number of its stroke, (N,) each.

    Readings are in the order in which they were taken. One that has not changed belongs to the
    stroke that brought it there; before the first motion the sign is 0.

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
    """Directions of approach and cycles of a positioning test by the order of its targets, (N,).

    A target was reached from the one before it; of one that stands twice where the motion turns,
    the second belongs to the way back. A step over more than half the travel begins a new cycle,
    and so does every second turn. All signs are 0 where most rows repeat the one before: their
    order shows nothing.

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
