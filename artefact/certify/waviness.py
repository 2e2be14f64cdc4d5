"""Waves of a face that its grid of points does not see, from dense lines across it.

A grid of pitch p aliases waves shorter than 2 p: the fitted surface follows a longer wave that is
not there, and its residuals do not show it. Points on a line at another phase of the grid do. They
take no part in the fit, and their deviations from the fitted surface are

    mean d^2 = u_point^2 + (error of the fit)^2 + (waves that it does not follow)^2.

A line shows waves across its own direction alone, so two are needed. For a direction without a line
an assumption about waviness is taken.
"""

from typing import NamedTuple

import numpy as np

from matstd.twin.frames import Array, Mask

WIDTH_OF_LINE = 0.4  # between the outermost points of one line, across it, mm
MAX_SPACING = 2.0  # largest distance between neighbours of a line, mm: waves of 4 mm are seen
MIN_LINE_SHARE = 0.6  # smallest length of a line, as a share of the face

MAX_SHARE_OF_LINES = 0.6
"""Share of the points of a face above which lines are no longer its exception: it was scanned."""


class Lines(NamedTuple):
    """Dense lines among the points of a face."""

    judging: Mask  # points of lines, which judge the fit of the others, (N,)
    seen: tuple[bool, bool]  # whether waves along u and along v are seen


def dense_lines(uv: Array, half_size: tuple[float, float]) -> Lines:
    """Find lines along u and v among points (N, 2), mm; none judge where all of a face is dense."""
    on_line = np.zeros(len(uv), dtype=bool)
    seen = []
    for axis in (0, 1):
        along = _on_lines(uv[:, axis], uv[:, 1 - axis], MIN_LINE_SHARE * 2.0 * half_size[axis])
        seen.append(bool(along.any()))
        on_line |= along
    if on_line.mean() > MAX_SHARE_OF_LINES:
        on_line[:] = False
    return Lines(on_line, (seen[0], seen[1]))


def _on_lines(along: Array, across: Array, length: float) -> Mask:
    """Points of lines that are long and dense enough, (N,)."""
    out = np.zeros(len(along), dtype=bool)
    tried = np.zeros(len(along), dtype=bool)
    for i in range(len(along)):
        if tried[i]:
            continue
        here = np.abs(across - across[i]) < 0.5 * WIDTH_OF_LINE
        tried |= here
        places = np.sort(along[here])
        if places[-1] - places[0] >= length and np.diff(places).max() <= MAX_SPACING:
            out |= here
    return out


def u_waves(deviation: Array, u_point: float) -> float:
    """Root mean square error of a fit at new points, whose deviations from it are (N,), mm.

    Not below what N points can show: the standard deviation of their mean square by noise alone.
    """
    unexplained = float(np.mean(deviation**2)) - u_point**2
    return float(np.sqrt(max(unexplained, u_point**2 * np.sqrt(2.0 / len(deviation)))))
