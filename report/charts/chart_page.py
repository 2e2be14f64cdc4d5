"""The page of a trend: what changed and when, its charts, and a table of all of them."""

from collections.abc import Sequence
from datetime import timedelta
from pathlib import Path
from typing import Any

import numpy as np

from matstd.diagnosis.charts import ControlChart, History, LimitSource, Overall
from matstd.diagnosis.geometry import Quantity
from matstd.report.charts.chart_words import (
    beyond_line,
    change_lines,
    chart_name,
    drift_words,
    history_lines,
    history_sentence,
    meaning,
    when_words,
)
from matstd.report.geometry import estimate_words, shown_unit
from matstd.report.layout import KeyFigure, Page, Picture, Section, Table, write_page
from matstd.report.numbers import digits, plural, sentence, signed
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
    axes.set(ylabel=unit, xlim=(found.days[0] - edge, found.days[-1] + edge))
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


_CHARTS = (
    "Dots: one run each, with its standard uncertainty. Line and band: mean and control limits, "
    "mean ± 3 s, between changes. Red line: a step, with the time in which it happened. Orange: a "
    "drift. Red dot: a value beyond the limits."
)
_METHOD = (
    "Every run is fitted by itself, with one model. A chart is one of single values (ISO 7870-2). "
    "s is the larger of the stated standard uncertainty and the scatter of the differences from "
    "run to run (their median over 0.954, from five runs on). A quantity is described as constant, "
    "as constant between steps, or as drifting, whichever leaves the least sum of squares beyond "
    "what chance accounts for over all quantities and dates. Uncertainties are standard "
    "uncertainties (k = 1); what all runs share, such as the calibration of the standard, changes "
    "no difference and is not in a change."
)
_TABLE = "All charts. Smallest step: what these runs would show of a step in the middle"

_GROUPS = {
    "Rotary axes": (Quantity.ROTARY_LINE, Quantity.ROTARY_ZERO),
    "Squareness and scales": (Quantity.SQUARENESS, Quantity.SCALE),
    "Joints and links": (
        Quantity.JOINT_ZERO,
        Quantity.LINK_LENGTH,
        Quantity.JOINT_OFFSET,
        Quantity.LINK_TWIST,
    ),
    "Backlash and named effects": (Overall.BACKLASH, Overall.EFFECT),
    "Volumetric error and proof": (Overall.VOLUME, Overall.FIRST, Overall.PROOF),
}
"""Charts by chapter."""


def write_history_page(found: History, folder: str | Path, title: str, follows: str = "") -> None:
    """Write `report.html`, pictures and tables into a folder; `follows` is the next command."""
    page = Page(
        heading=f"Control charts of {found.occasions[0].chain.name}, {title}",
        lead=history_sentence(found),
        means=meaning(found),
        next=_todo(found, follows),
        key=_key(found),
        sections=[*_changes(found), *_groups(found), *_all(found)],
        foot=_foot(found),
    )
    write_page(Path(folder) / "report.html", page)


def _todo(found: History, follows: str) -> str:
    if not found.changed:
        return "Probe again as before; a chart becomes sharper with every run."
    words = "Look for the cause at the date of the change"
    return f"{words}; `{follows}` compares the runs around it." if follows else f"{words}."


def _key(found: History) -> list[KeyFigure]:
    changed = len(found.changed)
    steps = sum(len(chart.course.steps) for chart in found.charts)
    drifts = sum(chart.course.drift is not None for chart in found.charts)
    period = f"{digits(found.days[-1], 3)} days" if found.is_dated else "order of names"
    return [
        KeyFigure(
            f"{changed} of {len(found.charts)}",
            f"quantities changed: {plural(steps, 'step')}, {plural(drifts, 'drift')}",
            "bad" if changed else "good",
        ),
        KeyFigure(plural(len(found.occasions), "run"), period),
        KeyFigure(f"{found.beyond} of {found.values}", "values beyond the limits"),
    ]


def _changes(found: History) -> list[Section]:
    """What changed, first in words, then in charts."""
    if not found.changed:
        return []
    lines = [sentence(line) for chart in found.changed for line in change_lines(found, chart)]
    drawn = Picture("pictures/changed.png", _CHARTS, draw_charts(found, found.changed))
    return [Section("What changed", items=lines, pictures=[drawn])]


def _groups(found: History) -> list[Section]:
    """The other charts by chapter; the first chapter explains them where nothing changed."""
    out: list[Section] = []
    for title, quantities in _GROUPS.items():
        charts = [c for c in found.charts if c.of.quantity in quantities and not c.has_changed]
        if charts:
            explained = _CHARTS if not found.changed and not out else f"{title}: no change."
            file = f"pictures/{title.split()[0].lower()}.png"
            out.append(
                Section(title, pictures=[Picture(file, explained, draw_charts(found, charts))])
            )
    return out


def _all(found: History) -> list[Section]:
    """All charts in a table, and the method."""
    rows = [_row(found, chart) for chart in found.charts]
    columns = ("quantity", "mean ± u", "limits", "s", "s from", "smallest step", "change")
    changed = [i for i, chart in enumerate(found.charts) if chart.has_changed]
    values = "The values are in `trend.csv`."
    return [
        Section("All charts", table=Table(columns, rows, _TABLE, changed), sentences=[values]),
        Section("Method", sentences=[_METHOD, *(sentence(w) for w in history_lines(found)[-2:])]),
        Section("Runs", table=_runs(found)),
    ]


def _row(found: History, chart: ControlChart) -> list[str]:
    """One chart: its last segment, limits, what it would show, what it shows."""
    unit, factor = shown_unit(chart.of.unit)
    last = chart.segments[-1]
    low, high = (digits(v / factor) for v in chart.limits(last))
    return [
        chart_name(chart.of),
        estimate_words(last.centre, chart.of.unit),
        f"{low} to {high}",
        f"{digits(chart.sigma / factor, 2)} {unit}",
        "stated" if chart.source is LimitSource.STATED else "scatter",
        f"{digits(chart.smallest_step(len(found.charts)) / factor, 2)} {unit}",
        _changed(found, chart),
    ]


def _changed(found: History, chart: ControlChart) -> str:
    unit, factor = shown_unit(chart.of.unit)
    if chart.course.drift is not None:
        return drift_words(found, chart.course.drift, chart.of.unit)
    return "\n".join(
        f"{signed(s.size.value / factor, s.size.u / factor, unit)} {when_words(found, chart, s)}"
        for s in chart.course.steps
    )


def _runs(found: History) -> Table:
    columns = ("run", "date", "touches", "standard")
    rows = [
        [
            f"`{one.name}`",
            "" if one.date is None else f"{one.date:%Y-%m-%d %H:%M}",
            str(one.touches),
            one.standard,
        ]
        for one in found.occasions
    ]
    return Table(columns, rows)


def _foot(found: History) -> list[str]:
    first = found.occasions[0]
    standard = next((one.standard for one in found.occasions if one.standard), "not recorded")
    return [
        f"Machine {first.chain.name}, hash {first.chain.fingerprint}. Standard: {standard}. "
        f"{sentence(beyond_line(found))}"
    ]
