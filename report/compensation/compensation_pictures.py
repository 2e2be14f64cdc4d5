"""Pictures of a compensation: over the workspace, error by error, along a program or path."""

from collections.abc import Iterator, Mapping, Sequence
from typing import Any

import numpy as np

from matstd.compensation.field import Result, Share, UncorrectedError
from matstd.compensation.programs import Compensated
from matstd.report.compensation.compensation_words import SMALLEST_OF_TOOL
from matstd.report.numbers import with_uncertainty
from matstd.report.style import (
    BLUE,
    FAINT,
    INK,
    NEUTRAL,
    RED,
    SOFT,
    Figure,
    figure,
    nothing,
    plain,
    series,
)
from matstd.twin.frames import Array
from matstd.twin.numbers import rms_length
from matstd.twin.sampling import spread_rows
from matstd.twin.units import MINUTE, UM

LONGEST_NAME = 32  # letters of a label
LINES, SHARES = 6, 16  # errors that are drawn along the path, and as bars, at most


def draw_shares_along(time: Array, whole: Array, shares: Sequence[Share]) -> Figure:
    """Size of the deviation along the path, of all together and of the largest by themselves.

    Args:
        time: Time at every pose, (N,), s; equal times are drawn by their number.
        whole: Deviation of all together, (N, 3), mm.
        shares: Share of each error, the largest first.
    """
    shown = [s for s in shares[:SHARES] if rms_length(s.field) > 0.0]
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
    right.set(xlim=(0.0, None), xlabel="µm, rms along the path, each by itself")
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


DRAWN_SIZE = 0.06  # share of the path's size as which its largest deviation is drawn
DRAWN_POINTS = 6000  # points that are drawn at most


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
        label = "uncertainty of the model (u)"
        if done.u_tool > SMALLEST_OF_TOOL:
            label += ", tools set relative to the probe"
        right.plot(at, done.u / UM, ":", color=INK, lw=1.2, label=label)
    right.set(yscale="log", xlabel="time in min", ylabel="error of the tool point in µm")
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
    gain = DRAWN_SIZE * max(float(wide.max()), 1.0) / worst
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
    ax.set(xlabel=f"{'xyz'[i]} in mm", ylabel=f"{'xyz'[j]} in mm")
    ax.set_title(f"deviations {gain:.0f} times", fontsize=9)
    ax.legend(fontsize=8, frameon=False)


BARS = 16  # errors that are drawn at most
SMALLEST_DRAWN = 1e-3  # µm: a logarithmic scale begins there, at a nanometre


def draw_errors_left(results: Mapping[str, Result]) -> Figure:
    """Share of the workspace whose error is smaller: before, and after every compensation."""
    drawn = figure(3.6)
    ax = drawn.subplots()
    first = next(iter(results.values()))
    _curve(ax, np.linalg.norm(first.before, axis=1), "before", INK, "-")
    for k, (title, result) in enumerate(results.items()):
        after = np.linalg.norm(result.after, axis=1)
        _curve(ax, after, title, series(k), "-")
        if result.u_rms > 0.0:
            _curve(ax, np.hypot(after, result.u), None, series(k), ":")
    ax.set_xscale("log")
    ax.set_ylim(0.0, 1.0)
    ax.set_xlabel("error of the tool point, µm (dotted: with the uncertainty of the model)")
    ax.set_ylabel("share of poses below")
    ax.legend(fontsize=8, frameon=False, loc="lower left", bbox_to_anchor=(0.0, 1.0), ncols=3)
    plain(ax)
    return drawn


def _curve(ax: object, size: np.ndarray, label: str | None, colour: str, style: str) -> None:
    x = np.maximum(np.sort(size) / UM, SMALLEST_DRAWN)
    y = (np.arange(len(x)) + 1.0) / len(x)
    ax.plot(x, y, style, color=colour, lw=1.4, label=label)  # type: ignore[attr-defined]


def draw_shares(left: Sequence[UncorrectedError]) -> Figure:
    """Every error before and after one compensation."""
    shown = [item for item in left[:BARS] if item.before > 0.0]
    if not shown:
        return nothing("No error remains.")
    drawn = figure(0.9 + 0.24 * len(shown))
    ax = drawn.subplots()
    y = np.arange(len(shown))[::-1]
    ax.barh(y, [item.before / UM for item in shown], color=NEUTRAL, height=0.7, label="before")
    ax.barh(y, [item.rms / UM for item in shown], color=series(0), height=0.4, label="remaining")
    errors = [item.u / UM for item in shown]
    ax.errorbar(
        [item.rms / UM for item in shown], y, xerr=errors, fmt="none", ecolor=SOFT, capsize=2
    )
    ax.set_yticks(y, [item.name for item in shown])
    ax.set(xlim=(0.0, None), xlabel="µm, rms over the workspace")
    ax.legend(fontsize=8, frameon=False)
    plain(ax, "x")
    return drawn
