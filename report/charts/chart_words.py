"""What changed on a machine, when, and how certainly, in words."""

from collections.abc import Iterator
from datetime import timedelta

from matstd.diagnosis.charts import (
    ALPHA,
    Charted,
    ControlChart,
    Drift,
    History,
    LimitSource,
    Overall,
    Step,
)
from matstd.diagnosis.geometry import Estimate
from matstd.report.geometry import estimate_words, quantity_name, shown_unit
from matstd.report.numbers import digits, p_value, percent, plural, signed
from matstd.twin.display import text

WEEK = 7.0  # days of the unit of time in which a drift is reported
BY_CHANCE = 0.0027  # share of normal values beyond three standard deviations


def chart_name(charted: Charted) -> str:
    """`line of C in X (EX0C)`, `backlash(B)`, `volumetric error`."""
    if isinstance(charted.quantity, Overall):
        return charted.symbol or charted.quantity.value
    return quantity_name(charted)


def history_sentence(found: History) -> str:
    """The result in one sentence: how many quantities changed."""
    what = (
        f"{plural(len(found.occasions), 'run')} of {found.occasions[0].chain.name}{_period(found)}"
    )
    changed, every = len(found.changed), len(found.charts)
    if changed:
        return f"{what}: {changed} of {every} charted quantities changed beyond chance."
    return f"{what}: none of {every} charted quantities changed beyond chance."


@text.register
def _text(found: History) -> str:
    return "\n- ".join([history_sentence(found), *history_lines(found)])


def _period(found: History) -> str:
    first, last = found.occasions[0].date, found.occasions[-1].date
    return f" from {first.date()} to {last.date()}" if found.is_dated and first and last else ""


def history_lines(found: History) -> list[str]:
    """Every change, the most certain first; then what the limits and their judgement rest upon."""
    out = [line for chart in found.changed for line in change_lines(found, chart)]
    out.append(beyond_line(found))
    by_scatter = [c for c in found.charts if c.source is LimitSource.SCATTER]
    named = f" ({', '.join(chart_name(c.of) for c in by_scatter[:4])})" if by_scatter else ""
    out.append(
        f"limits: mean ± 3 s; s is the stated uncertainty of "
        f"{len(found.charts) - len(by_scatter)} quantities, the larger scatter of the differences "
        f"from run to run of {len(by_scatter)}{named}"
    )
    if found.widening > 1.0:
        out[-1] += (
            f"; all quantities together scatter {digits(found.widening, 2)} times as much as "
            "stated, and every s is widened by that"
        )
    if not found.is_dated:
        out.append(
            "not every run has a date of its own: the order is that of the names, and times are "
            "counted in runs (state `# date = 2031-05-06` in the head, or the date in the name)"
        )
    return out


def change_lines(found: History, chart: ControlChart) -> Iterator[str]:
    """The steps of a quantity, or its drift."""
    name, unit = chart_name(chart.of), chart.of.unit
    for k, step in enumerate(chart.course.steps):
        before, now = (chart.segments[k + i].centre for i in (0, 1))
        yield (
            f"{name} changed by {_signed(step.size, unit)} {when_words(found, chart, step)}, from "
            f"{estimate_words(before, unit)} to {estimate_words(now, unit)} (probability by chance "
            f"{p_value(step.p_value)})"
        )
    if chart.course.drift is not None:
        yield f"{name} {drift_words(found, chart.course.drift, unit)}"


def when_words(found: History, chart: ControlChart, step: Step) -> str:
    """`about 2026-02-05 ± 2.0 days, between 2026-02-02 and 2026-02-09`."""
    before, after = (found.occasions[chart.rows[step.after - i]].name for i in (1, 0))
    between = f"between {before} and {after}"
    if found.begin is None:
        return between
    date = (found.begin + timedelta(days=step.date)).date()
    return f"about {date} ± {digits(step.u_date, 2)} days, {between}"


def drift_words(found: History, drift: Drift, unit: str) -> str:
    """`drifts by -4.1 ± 0.5 µrad a week, -37.0 ± 4.8 µrad in all (probability by chance 1e-9)`."""
    period = float(found.days[-1] - found.days[0])
    pace, word = (WEEK, "a week") if found.is_dated else (1.0, "from run to run")
    rate, whole = (Estimate(drift.rate.value * t, drift.rate.u * t) for t in (pace, period))
    return (
        f"drifts by {_signed(rate, unit)} {word}, {_signed(whole, unit)} in all (probability by "
        f"chance {p_value(drift.p_value)})"
    )


def beyond_line(found: History) -> str:
    """Values beyond the limits, beside those that chance puts there."""
    expected = digits(BY_CHANCE * found.values, 2)
    return (
        f"{found.beyond} of {found.values} values beyond the limits of their charts; chance puts "
        f"{expected} there"
    )


def meaning(found: History) -> str:
    """What the result means for the use of the machine."""
    risk = f"chance reports a change in {percent(ALPHA)} of such histories"
    if not found.changed:
        return (
            "The machine is in the state in which it was measured first, as far as these runs "
            f"show; what they would have shown stands in the table ({risk}). The model of the "
            "machine remains valid."
        )
    return (
        f"The machine is no longer in the state of the first run ({risk}). A step has a cause "
        "at its date: a collision, a repair, a new table of compensation. A drift has one that "
        "goes on: wear, foundation, season. Models and compensations from before a change do not "
        "hold after it."
    )


def _signed(estimate: Estimate, unit: str) -> str:
    shown, factor = shown_unit(unit)
    return signed(estimate.value / factor, estimate.u / factor, shown)
