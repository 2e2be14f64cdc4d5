"""Pictures of the error after compensation: over the workspace, and error by error."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING

import numpy as np

from matstd.compensation.field import Result, UncorrectedError
from matstd.report.style import INK, NEUTRAL, SOFT, figure, nothing, plain, series
from matstd.twin.units import UM

if TYPE_CHECKING:
    from matplotlib.figure import Figure

BARS = 16
"""Errors that are drawn at most."""

LEAST = 1e-3
"""µm: a logarithmic scale begins there, at a nanometre."""


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
    ax.legend(fontsize=8, frameon=False, loc="upper left")
    plain(ax)
    return drawn


def _curve(ax: object, size: np.ndarray, label: str | None, colour: str, style: str) -> None:
    x = np.maximum(np.sort(size) / UM, LEAST)
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
    ax.set_xlim(0.0, None)
    ax.set_xlabel("µm, rms over the workspace")
    ax.legend(fontsize=8, frameon=False)
    plain(ax, "x")
    return drawn
