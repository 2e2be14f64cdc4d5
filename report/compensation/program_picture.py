"""The picture of a compensated program: nominal, actual and compensated path, and its errors."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from matstd.compensation.programs import Compensated
from matstd.report.style import BLUE, FAINT, INK, RED, figure, plain
from matstd.twin.sampling import spread_rows
from matstd.twin.units import MINUTE, UM

if TYPE_CHECKING:
    from matplotlib.figure import Figure

SHOWN = 0.06
"""Share of the path's size as which its largest deviation is drawn."""

DRAWN_POINTS = 6000
"""Points that are drawn at most."""


def draw_program(done: Compensated) -> Figure:
    """Draw the path in its widest plane, deviations exaggerated, and their size over time."""
    rows = spread_rows(len(done.q), DRAWN_POINTS)
    drawn = figure(4.2)
    left, right = drawn.subplots(1, 2)
    _path(left, done, rows)
    rows = rows[done.is_stated[rows]]
    t = done.elapsed[rows] / MINUTE
    for field, colour, label in (
        (done.before, RED, "without"),
        (done.after, BLUE, "with compensation, at line ends"),
    ):
        size = np.linalg.norm(field[rows], axis=1) / UM
        right.plot(t, np.maximum(size, 1e-3), color=colour, lw=1.2, label=label)
    if done.is_cut:
        between = np.maximum(done.between[rows] / UM, 1e-3)
        right.plot(t, between, color=BLUE, lw=0.8, alpha=0.5, label="between line ends")
        right.axhline(done.tolerance / UM, color=FAINT, lw=0.8, label="tolerance of the division")
    if done.u.any():
        at = done.elapsed[done.u_at] / MINUTE
        right.plot(at, done.u / UM, ":", color=INK, lw=1.2, label="uncertainty of the model (u)")
    right.set_yscale("log")
    right.set_xlabel("time in min")
    right.set_ylabel("error of the tool point in µm")
    right.legend(fontsize=8, frameon=False)
    for ax in (left, right):
        plain(ax)
    return drawn


def _path(ax: Any, done: Compensated, rows: np.ndarray) -> None:
    """Nominal, actual and compensated path in the plane in which it is widest."""
    points = done.nominal[rows]
    is_hole = np.array([m.cycle is not None for m in done.program.motions])[done.motion[rows]]
    wide = np.ptp(points, axis=0)
    is_rapid = np.array([m.is_rapid for m in done.program.motions])[done.motion[rows]]
    if not is_rapid.all():  # what cuts nothing would cross the picture
        points = np.where(is_rapid[:, None], np.nan, points)
        wide = np.nanmax(points, axis=0) - np.nanmin(points, axis=0)
    i, j = sorted(np.argsort(-wide)[:2])
    worst = max(float(np.linalg.norm(done.before[rows], axis=1).max()), 1e-9)
    gain = SHOWN * max(float(wide.max()), 1.0) / worst
    digit = 10.0 ** np.floor(np.log10(gain))
    gain = digit * np.floor(gain / digit)
    for field, colour, style, label in (
        (0.0 * done.before, FAINT, "-", "nominal"),
        (done.before, RED, "-", "without"),
        (done.after, BLUE, "--", "with compensation"),
    ):
        shown = points + gain * field[rows]
        ax.plot(shown[:, i], shown[:, j], style, color=colour, lw=1.2, label=label)
        ax.plot(shown[is_hole, i], shown[is_hole, j], ".", color=colour, ms=4)
    ax.set_aspect("equal", adjustable="datalim")
    ax.set_xlabel(f"{'xyz'[i]} in mm")
    ax.set_ylabel(f"{'xyz'[j]} in mm")
    ax.set_title(f"deviations {gain:.0f} times", fontsize=9)
    ax.legend(fontsize=8, frameon=False)
