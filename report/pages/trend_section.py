"""The section of a page that tells how a machine changed over several runs."""

from dataclasses import dataclass
from pathlib import Path
from typing import Any

from matstd.diagnosis.answer import Trend
from matstd.diagnosis.geometry import Estimate, GeometryRow
from matstd.report.geometry import USUAL, change_sentences, estimate_words, quantity_name
from matstd.report.numbers import digits
from matstd.report.plots import draw_trend
from matstd.twin.units import UM

DRAWN = 8
"""Quantities that are drawn, those that changed first; with the errors that makes three rows."""

PICTURE = "trend.png"


@dataclass(frozen=True, slots=True)
class _Line:
    """A quantity with what changed into every run but the first, and whether beyond chance."""

    row: GeometryRow
    steps: list[Estimate | None]
    has_changed: list[bool]


def trend_section(trend: Trend | None, place: Path) -> dict[str, Any] | None:
    """What `trend.html` needs, its picture drawn; nothing for a single run.

    Args:
        trend: Of the diagnosis.
        place: Folder of the pictures.
    """
    if trend is None:
        return None
    later = range(1, len(trend.runs))
    best = {i: trend.known_best(i) for i in later}
    lines = _first_changed(
        [
            _Line(
                row,
                [best[i][k].steps[i - 1] for i in later],
                [best[i][k].has_changed_into(i) for i in later],
            )
            for k, row in enumerate(trend.rows)
            if any(row.course)
        ]
    )
    draw_trend(place / PICTURE, trend, [(n.row, n.has_changed) for n in lines[:DRAWN]])
    return {
        "sentences": change_sentences(trend),
        "names": [run.name for run in trend.runs],
        "picture": PICTURE,
        "runs": [
            {
                "name": run.name,
                "touches": run.touches,
                "figures": [_um(v) for v in (run.rms, run.test_rms, run.left_out)],
                "changed": "held out"
                if run.is_held_out
                else "changed"
                if i in trend.changed
                else "as before"
                if i
                else "",
            }
            for i, run in enumerate(trend.runs)
        ],
        "rows": [
            {
                "name": quantity_name(line.row),
                "course": [_sized(e, line.row) for e in line.row.course],
                "steps": [_sized(e, line.row) for e in line.steps],
                "is_noted": any(line.has_changed),
            }
            for line in lines
        ],
    }


def _sized(estimate: Estimate | None, row: GeometryRow) -> str:
    return "" if estimate is None else estimate_words(estimate, row.unit)


def _um(value: float | None) -> str:
    return "" if value is None else digits(value / UM)


def _first_changed(lines: list[_Line]) -> list[_Line]:
    """Quantities by what a reader wants to see: changes, then squareness and scales, then all."""
    return sorted(lines, key=lambda n: (not any(n.has_changed), n.row.quantity not in USUAL))
