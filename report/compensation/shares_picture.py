"""Contribution of each error along a path: a picture, and lines for the console."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from typing import TYPE_CHECKING

import numpy as np

from matstd.compensation.field import Share
from matstd.report.numbers import with_uncertainty
from matstd.report.style import INK, NEUTRAL, SOFT, figure, plain, series
from matstd.twin.frames import Array
from matstd.twin.numbers import rms_length
from matstd.twin.units import MINUTE, UM

if TYPE_CHECKING:
    from matplotlib.figure import Figure

LONGEST_NAME = 32
"""Letters of a label."""

LINES, BARS = 6, 16
"""Errors that are drawn along the path, and as bars, at most."""


def draw_shares_along(time: Array, whole: Array, shares: Sequence[Share]) -> Figure:
    """Size of the deviation along the path, of all together and of the largest by themselves.

    Args:
        time: Time at every pose, (N,), s; equal times are drawn by their number.
        whole: Deviation of all together, (N, 3), mm.
        shares: Share of each error, the largest first.
    """
    shown = [s for s in shares[:BARS] if rms_length(s.field) > 0.0]
    drawn = figure(max(3.6, 0.9 + 0.24 * len(shown)))
    left, right = drawn.subplots(1, 2)
    is_timed = np.ptp(time) > 0.0
    x = time / MINUTE if is_timed else np.arange(len(time))
    left.plot(x, np.linalg.norm(whole, axis=1) / UM, color=INK, lw=1.6, label="all together")
    for k, share in enumerate(shown[:LINES]):
        size = np.linalg.norm(share.field, axis=1) / UM
        left.plot(x, size, color=series(k), lw=1.1, label=_short(share.name))
    left.set_xlabel("time in min" if is_timed else "pose")
    left.set_ylabel("deviation of the tool point in µm")
    left.legend(fontsize=8, frameon=False)
    y = np.arange(len(shown))[::-1]
    sizes = [rms_length(s.field) / UM for s in shown]
    colours = [series(k) if k < LINES else NEUTRAL for k in range(len(shown))]
    right.barh(y, sizes, color=colours, height=0.7)
    errors = [s.u / UM for s in shown]
    right.errorbar(sizes, y, xerr=errors, fmt="none", ecolor=SOFT, capsize=2)
    right.set_yticks(y, [_short(s.name) for s in shown])
    right.set_xlim(0.0, None)
    right.set_xlabel("µm, rms along the path, each by itself")
    plain(left)
    plain(right, "x")
    return drawn


def _short(name: str) -> str:
    """A name as a label: a beam is known by its axis."""
    return name if len(name) <= LONGEST_NAME else f"{name[:LONGEST_NAME].rpartition(',')[0]},...)"


def share_lines(whole: Array, shares: Sequence[Share]) -> Iterator[str]:
    """The total, and its eight largest contributions."""
    yield f"all together {with_uncertainty(rms_length(whole) / UM, None, 'µm')} rms"
    for share in shares[:8]:
        yield f"- {share.name} {_size(share)}"


def _size(share: Share) -> str:
    return with_uncertainty(rms_length(share.field) / UM, share.u / UM or None, "µm")
