"""The next visit in words: what it distinguishes, its schedule, its power, or why there is none."""

import numpy as np

from matstd.diagnosis.next_visit import NoPlan, RivalPower, VisitPlan
from matstd.probe_paths.locate import VisitSchedule
from matstd.report.laws.law_words import carrier_words, short_words
from matstd.report.layout import Section, Table
from matstd.report.numbers import digits, odds_words, span, um
from matstd.twin.laws import law_of
from matstd.twin.model import Effect
from matstd.twin.words import listed

FILE = "next_visit.csv"

_HOW = (
    "Touch the points in the order of the file, in the set-ups of the run and with the "
    "temperatures recorded; then learn from both runs. Of a standard that was designed here "
    "`matstd replan next_visit.csv --design OUT` writes the programs."
)


def visit_sentences(plan: VisitPlan) -> list[str]:
    """What a visit would decide and how it is made, or why none would decide; none without law."""
    if plan.refusal is NoPlan.NO_LAW or plan.law is None:
        return []
    classes = (_indistinct_sentence(plan), _alike_sentence(plan))
    if plan.refusal is not None:
        lines = [f"No next visit is planned: {plan.refusal.value}."]
    else:
        lines = [_touches_sentence(plan), _power_sentence(plan), _unseen_sentence(plan)]
    return [line for line in (*lines, *classes) if line]


def visit_section(plan: VisitPlan) -> list[Section]:
    """The next visit on a page."""
    said = visit_sentences(plan)
    if not said:
        return []
    rows = [_row(one) for one in plan.rivals]
    head = ("rival", "odds against it now", "separation", "odds of 20 : 1 after the visit")
    table = Table(head, rows, "What the visit does where the law holds") if rows else None
    how = [_HOW] if plan.touches is not None else []
    return [Section("The next visit", sentences=[*said, *how], table=table)]


def _row(one: RivalPower) -> list[str]:
    power = "not distinguished" if one.power is None else f"{100 * one.power:.0f} %"
    apart = f"{digits(one.separation, 2)} standard deviations"
    return [_name(one.effect), odds_words(one.log_odds), apart, power]


def _name(effect: Effect) -> str:
    law = law_of(effect)
    return effect.name if law is None else short_words(law)


def _short(effect: Effect, law: Effect | None) -> str:
    """The carrier alone where all else is as in the law."""
    one, other = law_of(effect), None if law is None else law_of(law)
    if one is not None and other is not None and one.factors == other.factors:
        return carrier_words(one.carrier)
    return _name(effect)


def _touches_sentence(plan: VisitPlan) -> str:
    t = plan.touches
    assert t is not None
    poses = len(np.unique(t.pose))
    return (
        f"Next visit ({FILE}): {len(t)} touches in {poses} poses within {span(float(t.time[-1]))}, "
        f"{_schedule_words(plan)}."
    )


def _schedule_words(plan: VisitPlan) -> str:
    """`from a cold machine, with a pause of 60.0 min after touch 64`."""
    s = plan.schedule
    parts = ["from a cold machine"]
    if s.warm_up:
        parts = [f"after the machine has moved for {span(s.warm_up)}"]
    if plan.pause_after is not None:
        parts.append(f"with a standstill of {span(s.pause)} after touch {plan.pause_after}")
    if s.slowness != 1.0:
        parts.append(f"{s.slowness:g} times as slow from touch to touch as the run")
    return ", ".join(parts)


def _power_sentence(plan: VisitPlan) -> str:
    seen = [f"{_name(r.effect)} ({digits(r.separation, 2)} σ)" for r in plan.rivals
            if r.is_distinguished and not r.is_unseen]  # fmt: skip
    power = 100 * (plan.power or 0.0)
    if not seen:
        return ""
    return (
        f"It distinguishes the law from {listed(seen, 'and')}. In {power:.0f} % of simulated "
        "visits the true one of those that it distinguishes gets odds of 20 : 1."
    )


def _unseen_sentence(plan: VisitPlan) -> str:
    """Where a visit shows the law and the run does not."""
    shown = [f"{law.factors[-1].driver.name} ({digits(r.separation, 2)} σ)" for r in plan.rivals
             if r.is_distinguished and r.is_unseen and (law := law_of(r.effect))]  # fmt: skip
    if not shown:
        return ""
    return f"It shows whether the law acts at other readings, too, of {listed(shown, 'and')}."


def _indistinct_sentence(plan: VisitPlan) -> str:
    """What no visit distinguishes, and how little depends on it."""
    if not plan.indistinct:
        return ""
    names = [f"{_short(r.effect, plan.law)} ({digits(r.separation, 2)} σ)" for r in plan.indistinct]
    most = max(one.difference for one in plan.indistinct)
    return (
        f"No visit with this standard on this machine distinguishes the law from "
        f"{listed(names, 'or')}: at its touches they differ by {um(most, 2)} rms at most, beyond "
        "what their parameters and a new clamping make up for, so that either predicts these."
    )


def _alike_sentence(plan: VisitPlan) -> str:
    if not plan.alike:
        return ""
    names = listed([_short(effect, plan.law) for effect in plan.alike], "and")
    return (
        f"One class with the law, since they do the same at every touch that can be made: {names}."
    )


def made_on_twin(touches: int, duration: float) -> str:
    """What the programs of a planned visit made on the twin, and how long they take, s."""
    return f"The twin made all {touches} touches, {span(duration)} without standstill."


def visit_conditions(schedule: VisitSchedule, resumed: str) -> list[str]:
    """What the operator does besides running the programs of a planned visit.

    Args:
        resumed: Name of the first program after the standstill; "" without one.
    """
    lines = ["Begin with a cold machine."]
    if schedule.warm_up:
        lines = [f"Let the machine move for {span(schedule.warm_up)} before the first program."]
    if resumed:
        lines.append(f"Stand still for {span(schedule.pause)} before {resumed}.")
    if schedule.slowness != 1.0:
        share = f"{100.0 / schedule.slowness:.0f} %"
        lines.append(f"The visit is planned slowly: feed override {share}.")
    return [*lines, "Record the temperatures of the run, and learn from both runs."]
