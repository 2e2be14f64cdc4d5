"""Control charts: values with uncertainties, mean, limits, steps and drift."""

from collections.abc import Sequence
from datetime import timedelta
from typing import Any

import numpy as np

from matstd.diagnosis.charts import ControlChart, History
from matstd.report.charts.chart_words import chart_name
from matstd.report.geometry import shown_unit
from matstd.report.style import BLUE, INK, ORANGE, RED, SOFT, WASH, Figure, figure, plain

ACROSS, HEIGHT = 2, 2.35  # charts side by side, and the height of a row, inch

MOST_TICKS = 8  # dates that are written below a chart


def draw_charts(found: History, charts: Sequence[ControlChart]) -> Figure:
    """Some charts, two in a row, on one axis of time."""
    count = -(-len(charts) // ACROSS)
    drawn = figure(HEIGHT * count)
    every = drawn.subplots(count, ACROSS, squeeze=False).ravel()
    for axes, chart in zip(every, charts, strict=False):
        _draw(axes, found, chart)
    for axes in every[len(charts) :]:
        axes.set_visible(False)
    return drawn


def _draw(axes: Any, found: History, chart: ControlChart) -> None:
    unit, factor = shown_unit(chart.of.unit)
    t = found.days[list(chart.rows)]
    x, u = np.array([(e.value, e.u) for e in chart.values]).T / factor
    edge = 0.5 * float(np.min(np.diff(found.days)))
    for part in chart.segments:
        low, high = (v / factor for v in chart.limits(part))
        begin, end = _ends(t, part.first, part.last, edge)
        axes.fill_between([begin, end], low, high, color=WASH, zorder=0)
        for y, style in ((low, "--"), (high, "--"), (part.centre.value / factor, "-")):
            axes.plot([begin, end], [y, y], style, color=SOFT, lw=0.9, zorder=1)
    for step in chart.course.steps:
        axes.axvline(step.date, color=RED, lw=1.0, zorder=1)
        wide = np.sqrt(3.0) * step.u_date
        axes.axvspan(step.date - wide, step.date + wide, color=RED, alpha=0.12, lw=0, zorder=0)
    drift = chart.course.drift
    if drift is not None:
        w = 1.0 / u**2
        centre, middle = float(w @ x / w.sum()), float(w @ t / w.sum())
        axes.plot(t, centre + drift.rate.value / factor * (t - middle), color=ORANGE, lw=1.6)
    axes.errorbar(t, x, u, fmt="o", color=BLUE, ecolor=BLUE, ms=4, lw=0.9, capsize=2, zorder=3)
    far = list(chart.beyond)
    axes.plot(t[far], x[far], "o", color=RED, ms=6, zorder=4)
    axes.set_title(chart_name(chart.of), fontsize=9, color=INK)
    axes.set_ylabel(unit)
    axes.set_xlim(found.days[0] - edge, found.days[-1] + edge)
    shown = range(0, len(found.days), -(-len(found.days) // MOST_TICKS))
    axes.set_xticks([found.days[i] for i in shown], [_label(found, i) for i in shown])
    axes.tick_params(axis="x", labelrotation=25)
    plain(axes, "y")


def _ends(t: Any, first: int, last: int, edge: float) -> tuple[float, float]:
    """Where the lines of a segment begin and end: half way to its neighbours."""
    begin = t[first] - edge if first == 0 else 0.5 * (t[first - 1] + t[first])
    end = t[last] + edge if last == len(t) - 1 else 0.5 * (t[last] + t[last + 1])
    return float(begin), float(end)


def _label(found: History, i: int) -> str:
    if found.begin is None:
        return found.occasions[i].name
    return f"{(found.begin + timedelta(days=float(found.days[i]))).date()}"
