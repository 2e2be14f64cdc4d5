"""What a compensated program leaves between the ends of its lines."""

import numpy as np

from matstd.compensation.field import actual_tip, shifted
from matstd.compensation.programs.path import ProgramPath, are_first, shares_of_lines
from matstd.twin.frames import Array
from matstd.twin.machine import tip
from matstd.twin.record import IntArray

CHECKED_SHARES = (0.25, 0.5, 0.75)
"""Shares of a line at which it is checked: the error of a chord is a parabola, largest in its
middle; that of a jump of the error is not."""

LINES_PER_BLOCK = 20_000
"""Lines that are checked together: bounds the memory."""


def off_path(path: ProgramPath, which: IntArray, share: Array, written: Array) -> Array:
    """Largest distance of the tool point from the path of the program inside every line, (N,), mm.

    The control moves all axes in proportion from one end of a line to the next; the exact twin says
    where the tool point then is. Its distance is taken square to the nominal path, so that a tool
    which is early or late on the path is not off it. nan for rapid motions, cycles, and lines that
    begin where no place is known.

    Args:
        which: Motion of every line, (N,).
        share: Share of its motion that is done at its end, (N,).
        written: Where it ends, program coordinates as written, (N, A).
    """
    begin = path.begins_at(which, written)
    part = shares_of_lines(which, share)
    seen = ~path.is_whole[which] & ~(are_first(which) & ~path.is_from_known[which])
    out = np.full(len(which), np.nan)
    todo = np.flatnonzero(seen)
    for low in range(0, len(todo), LINES_PER_BLOCK):
        rows = todo[low : low + LINES_PER_BLOCK]
        out[rows] = _largest(
            path, which[rows], (share - part)[rows], part[rows], begin[rows], written[rows]
        )
    return out


def _largest(
    path: ProgramPath, which: IntArray, start: Array, part: Array, begin: Array, end: Array
) -> Array:
    chain = path.errors.chain
    aims = [path.touches(which, start + s * part) for s in (0.0, *CHECKED_SHARES, 1.0)]
    nominal = [tip(chain, touches.q, touches.target) for touches in aims]
    worst = np.zeros(len(which))
    for k, place in enumerate(CHECKED_SHARES, start=1):
        along = nominal[k + 1] - nominal[k - 1]
        length = np.linalg.norm(along, axis=1, keepdims=True)
        along /= np.where(length > 0.0, length, 1.0)
        added = path.readings(which, begin + place * (end - begin)) - aims[k].q
        off = actual_tip(path.errors, shifted(aims[k], added)) - nominal[k] - path.aim
        off -= np.einsum("ni,ni->n", off, along)[:, None] * along
        worst = np.maximum(worst, np.linalg.norm(off, axis=1))
    return worst
