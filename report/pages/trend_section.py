"""The section of a page on changes of the machine between several runs."""

from dataclasses import dataclass

from matstd.diagnosis.answer import Trend
from matstd.diagnosis.geometry import Estimate, GeometryRow
from matstd.report.geometry import USUAL, change_sentences, estimate_words, quantity_name
from matstd.report.layout import Picture, Section, Table
from matstd.report.numbers import digits, sentence
from matstd.report.plots import draw_trend
from matstd.twin.units import UM

DRAWN = 8
"""Quantities that are drawn, those that changed first; with the errors that makes three rows."""

_PICTURE = (
    "Each run by itself, together with the effects found, with standard uncertainties. Dashed "
    "line: a change beyond chance. Last panel: error of poses, and of whole runs, that were left "
    "out and predicted from the rest."
)
_RUNS = (
    "Runs in the order given. A run left out is predicted with the machine of the run before it "
    "(the first run: with that of the run after it); its set-ups are fitted"
)
_QUANTITIES = (
    "Quantities of the geometry by run, and their changes from the run before, ± standard "
    "uncertainty. A change is more certain than the difference of two values whose uncertainty "
    "the runs share"
)


@dataclass(frozen=True, slots=True)
class _Line:
    """A quantity with its change into every run but the first, and whether beyond chance."""

    row: GeometryRow
    steps: list[Estimate | None]
    has_changed: list[bool]


def trend_sections(trend: Trend | None) -> list[Section]:
    """What changed between the runs; nothing for a single run."""
    if trend is None:
        return []
    later = range(1, len(trend.runs))
    best = {i: trend.known_best(i) for i in later}
    lines = [
        _Line(
            row,
            [best[i][k].steps[i - 1] for i in later],
            [best[i][k].has_changed_into(i) for i in later],
        )
        for k, row in enumerate(trend.rows)
        if any(row.course)
    ]
    # changes first, then squareness and scales
    lines.sort(key=lambda n: (not any(n.has_changed), n.row.quantity not in USUAL))
    drawn = draw_trend(trend, [(n.row, n.has_changed) for n in lines[:DRAWN]])
    runs = [
        [
            run.name,
            str(run.touches),
            *(_um(v) for v in (run.rms, run.test_rms, run.left_out)),
            _state(trend, i),
        ]
        for i, run in enumerate(trend.runs)
    ]
    names = [run.name for run in trend.runs]
    rows = [
        [quantity_name(n.row), *(_sized(e, n.row) for e in (*n.row.course, *n.steps))]
        for n in lines
    ]
    errors = ("fitted, µm", "poses left out, µm", "run left out, µm")
    changed = [i for i, n in enumerate(lines) if any(n.has_changed)]
    columns = ("quantity", *names, *(f"change into {name}" for name in names[1:]))
    return [
        Section(
            "Changes between the runs",
            sentences=[sentence(words) for words in change_sentences(trend)],
            pictures=[Picture("pictures/trend.png", _PICTURE, drawn)],
        ),
        Section(table=Table(("run", "touches", *errors, "geometry"), runs, _RUNS)),
        Section(table=Table(columns, rows, _QUANTITIES, changed)),
    ]


def _state(trend: Trend, run: int) -> str:
    if trend.runs[run].is_held_out:
        return "held out"
    if run in trend.changed:
        return "changed"
    return "unchanged" if run else ""


def _sized(estimate: Estimate | None, row: GeometryRow) -> str:
    return "" if estimate is None else estimate_words(estimate, row.unit)


def _um(value: float | None) -> str:
    return "" if value is None else digits(value / UM)
