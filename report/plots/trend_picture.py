"""Picture of a machine over several runs: changes, and how well each run is predicted."""

from collections.abc import Sequence

import numpy as np

from matstd.diagnosis.answer import Trend
from matstd.diagnosis.geometry import GeometryRow
from matstd.report.geometry import quantity_name, shown_unit
from matstd.report.style import BLUE, INK, RED, Figure, figure, plain, series
from matstd.twin.units import UM

ACROSS = 3  # quantities side by side
HEIGHT = 2.3  # height of one row of pictures, inch


def draw_trend(trend: Trend, rows: Sequence[tuple[GeometryRow, Sequence[bool]]]) -> Figure:
    """Some quantities over the runs with their standard uncertainties, then the errors of each run.

    Args:
        rows: Quantities to draw, one picture each, with whether each changed into every run but the
            first.
    """
    names = [run.name for run in trend.runs]
    count = -(-(len(rows) + 1) // ACROSS)
    drawn = figure(HEIGHT * count)
    every = drawn.subplots(count, ACROSS, squeeze=False).ravel()
    for axes, (row, has_changed) in zip(every, rows, strict=False):
        unit, factor = shown_unit(row.unit)
        known = [(i, e.value / factor, e.u / factor) for i, e in enumerate(row.course) if e]
        x, y, u = np.array(known).T
        axes.errorbar(x, y, u, fmt="o-", color=BLUE, capsize=3, lw=1.0, ms=4)
        for i in np.flatnonzero(has_changed):
            axes.axvline(i + 0.5, color=RED, lw=0.8, ls="--")
        axes.set_title(quantity_name(row), fontsize=9, color=INK)
        axes.set_ylabel(unit)
    axes = every[len(rows)]
    errors: dict[str, list[float | None]] = {
        "poses left out": [run.test_rms for run in trend.runs],
        "run left out": [run.left_out for run in trend.runs],
    }
    for k, (label, values) in enumerate(errors.items()):
        shown = [np.nan if v is None else v / UM for v in values]
        axes.plot(range(len(names)), shown, "s-", color=series(k), lw=1.0, ms=4, label=label)
    axes.set_title("error of poses and runs left out", fontsize=9, color=INK)
    axes.set_ylabel("µm rms")
    axes.set_ylim(bottom=0.0)
    axes.legend(frameon=False, fontsize=8)
    for axes in every[: len(rows) + 1]:
        axes.set_xticks(range(len(names)), names, rotation=20 if len(names) > 3 else 0)
        axes.set_xlim(-0.5, len(names) - 0.5)
        plain(axes)
    for axes in every[len(rows) + 1 :]:
        axes.set_visible(False)
    return drawn
