"""Changes between several runs in words; all lines on the geometry for the console."""

from collections.abc import Sequence

from matstd.diagnosis.answer import Trend
from matstd.diagnosis.faults import DescriptionFault
from matstd.diagnosis.geometry import Estimate, GeometryRow, LearntGeometry
from matstd.diagnosis.policy import POLICY
from matstd.report.effects import effect_title
from matstd.report.geometry.copied_numbers import copy_lines
from matstd.report.geometry.fault_words import fault_sentences
from matstd.report.geometry.geometry_words import (
    USUAL,
    estimate_words,
    far_lines,
    ladder_sentence,
    noted_lines,
    quantity_name,
    rotary_lines,
    shown_unit,
)
from matstd.report.numbers import digits, microns
from matstd.twin.record import Touches
from matstd.twin.units import UM

MAX_NAMED_CHANGES = 4  # changes of one run that a sentence lists, the largest over the travel first
MIN_MENTIONED = 3.0  # standard uncertainties from which a change below the limit is mentioned


def change_sentences(trend: Trend) -> list[str]:
    """A sentence for every run but the first: its changes, or the smallest detectable ones."""
    names = [run.name for run in trend.runs]
    out = []
    for i in range(1, len(names)):
        if trend.runs[i].is_held_out:
            continue
        earlier = max(k for k in range(i) if k == 0 or not trend.runs[k].is_held_out)
        between = f"from {names[earlier]} to {names[i]}"
        rows = changed_rows(trend, i)
        if i not in trend.changed:
            nothing = f"no change of the geometry was detected{_clearest(trend.rows, i)}"
            out.append(f"{between} {nothing}{_detectable(trend.rows, i)}")
        elif not rows:
            out.append(f"{between} the geometry changed{_alone(trend, i)}")
        else:
            changes = [_changed(row, i) for row in rows[:MAX_NAMED_CHANGES]]
            more = (
                f"; and {len(rows) - MAX_NAMED_CHANGES} more in the table"
                if len(rows) > MAX_NAMED_CHANGES
                else ""
            )
            out.append(f"{between} {'; '.join(changes)}{more}")
    return out


def trend_lines(trend: Trend | None) -> list[str]:
    """Lines on several runs for the console; none for a single run."""
    return [] if trend is None else [*change_sentences(trend), _left_out(trend)]


def _left_out(trend: Trend) -> str:
    """Error of each run as predicted from the others."""
    known = [(run.name, run.left_out) for run in trend.runs if run.left_out is not None]
    errors = [f"{name} {microns(error)}" for name, error in known]
    return f"each run predicted from the others, with its set-ups fitted: {', '.join(errors)} rms"


def _alone(trend: Trend, run: int) -> str:
    """The single change that would explain a run in which no quantity changed clearly."""
    single = trend.alone.get(run)
    if single is None:
        return ", but no single quantity beyond chance"
    size = estimate_words(single.size, single.unit)
    return f"; if only one error changed, {effect_title(single.effect)} by {size}"


def changed_rows(trend: Trend, run: int) -> list[GeometryRow]:
    """Quantities that changed into a run, the largest over the travel first."""
    changed = [row for row in trend.known_best(run) if row.has_changed_into(run)]
    return sorted(changed, key=lambda row: -_at_ends(row, run))


def _at_ends(row: GeometryRow, run: int) -> float:
    """Effect of a change over the travel, mm."""
    step = row.steps[run - 1]
    return 0.0 if step is None else abs(step.value) * row.lever


def _changed(row: GeometryRow, run: int) -> str:
    """`squareness of Y to X (EC0Y) changed by 38.0 ± 2.9 µrad, 19 µm over the travel, ...`."""
    step, now, before = row.steps[run - 1], row.course[run], _last(row.course[:run])
    assert step is not None  # it has changed
    over = "" if row.unit == "mm" else f" ({digits(_at_ends(row, run) / UM, 2)} µm over the travel)"
    was = "" if before is None else f" from {estimate_words(before, row.unit)}"
    to = "" if now is None else f" to {estimate_words(now, row.unit)}"
    return f"{quantity_name(row)} changed{was}{to}, by {estimate_words(step, row.unit)}{over}"


def _last(course: Sequence[Estimate | None]) -> Estimate | None:
    return next((e for e in reversed(course) if e is not None), None)


def _clearest(rows: Sequence[GeometryRow], run: int) -> str:
    """The change nearest to the limit, so that a user who expects it sees its size."""
    steps = [(row, row.steps[run - 1]) for row in rows]
    near = [(abs(s.value) / s.u, row, s) for row, s in steps if s is not None and s.u > 0.0]
    clear, row, step = max(near, key=lambda one: one[0], default=(0.0, None, None))
    if clear <= MIN_MENTIONED or row is None or step is None:
        return ""
    return f"; {quantity_name(row)} may have changed by {estimate_words(step, row.unit)}"


def _detectable(rows: Sequence[GeometryRow], run: int) -> str:
    """The smallest detectable changes of squareness and scales."""
    seen = []
    for row in rows:
        step = row.steps[run - 1]
        if row.quantity in USUAL and step is not None:
            unit, factor = shown_unit(row.unit)
            least = digits(POLICY.clear_change * step.u / factor, 2)
            seen.append(f"{quantity_name(row)} {least} {unit}")
    return f"; detection limits of these runs: {', '.join(seen)}" if seen else ""


def console_lines(
    touches: Touches,
    geometry: LearntGeometry,
    faults: Sequence[DescriptionFault],
    trend: Trend | None = None,
) -> list[tuple[str, bool]]:
    """Lines, each with whether it should be read first; changes replace the notable quantities."""
    first = [(text, True) for text in fault_sentences(faults)]
    first += [(text, False) for text in copy_lines(touches, geometry, faults)]
    first += [(text, True) for text in trend_lines(trend)]
    noted = noted_lines(geometry) if trend is None else far_lines(geometry)
    rest = (ladder_sentence(geometry), *noted, *rotary_lines(geometry))
    return first + [(text, False) for text in rest]
