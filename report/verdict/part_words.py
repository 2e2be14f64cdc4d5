"""Lines on the three parts of a verdict, on repeatability and on the errors to expect."""

from collections.abc import Sequence

import numpy as np

from matstd.diagnosis.accuracy import Promise, Repeatability, Scatter
from matstd.diagnosis.answer import (
    Comparison,
    Diagnosis,
    Doubt,
    GeometryPart,
    NamedEffect,
    Remainder,
    Step,
)
from matstd.diagnosis.geometry import GeometryRow
from matstd.diagnosis.policy import POLICY
from matstd.diagnosis.remarks import EffectOfOtherRun
from matstd.diagnosis.residual import Shape
from matstd.report.effects import DOUBTS, effect_words
from matstd.report.geometry import estimate_words, fault_sentences, quantity_name
from matstd.report.laws import learnt_words
from matstd.report.numbers import digits, microns, noun, odds_words, p_value, percent
from matstd.report.words import sizes, structure_words
from matstd.twin.library import title_of
from matstd.twin.words import few, listed

MAX_WRITTEN_OUT = 3  # quantities of the geometry that are written out; of more, the first ones

BROKEN_PROMISE = 1.1
"""Ratio of error to promise from which a prediction is worse than promised; the figures themselves
scatter by a few per cent."""

HOLDS_BELOW = 1.25
"""Errors of left-out blocks over their uncertainties up to which a model holds there."""


def part_lines(result: Diagnosis) -> list[tuple[str, str]]:
    """Heading and words of every part, in the order in which they are read."""
    parts = result.parts
    steps = {s.effect.name: s for s in result.steps if s.effect is not None}
    before = result.promise_before if result.has_fallen else None
    named = [_named(one, steps[one.effect.name]) for one in parts.named]
    beside = "beside the names withdrawn " if result.withdrawn else ""
    learnt = "" if result.laws is None else f"; {learnt_words(result.laws)}"
    return [
        ("geometry", _geometry(parts.geometry)),
        ("named effects", "; ".join(named) or _nothing_named(result)),
        ("what remains", f"{beside}{_remains(parts.remains, parts.repeatability)}{learnt}"),
        ("repeatability", repeatability_words(parts.repeatability, parts.remains.scatter)),
        ("error to expect", promise_words(result.promise, before)),
    ]


def _geometry(part: GeometryPart) -> str:
    """What the ordinary model learnt, what changed, what is too large, what that hints at."""
    out = [f"the ordinary model leaves a scatter of {microns(part.left)}"]
    if part.changed:
        out.append(f"changed: {_rows(part.changed)}")
    if part.beyond:
        out.append(f"larger than such a machine has: {_rows(part.beyond)}")
    if part.hints:
        out += fault_sentences(part.hints[:1])
    elif len([row for row in part.beyond if row.is_far]) > 1:
        out.append("the machine file or the set-up may be wrong")
    return "; ".join(out)


def _rows(rows: Sequence[GeometryRow]) -> str:
    words = [f"{quantity_name(r)} {estimate_words(r.estimate, r.unit)}" for r in rows]
    return few(words, MAX_WRITTEN_OUT)


def _named(one: NamedEffect, step: Step) -> str:
    """An effect with its size, its share, its probability by chance and its closest rival."""
    size = sizes(step, 2)
    weight = f"explains {percent(one.share)} of the excess ({microns(one.explained)} rms)"
    doubt = f", {DOUBTS[one.doubt]}" if one.doubt in DOUBTS else ""
    by_name = ", added by name" if step.is_named else ""
    inside = ", ".join(word for word in (size, weight, _chance(one.p_value)) if word)
    gone = "withdrawn: " if one.doubt is Doubt.WITHDRAWN else ""
    return f"{gone}{effect_words(one.effect)}: {inside}{doubt}{by_name}{_rival(one)}"


def _chance(p: float) -> str:
    """`p = 0.02`, or `p < 1e-12`."""
    words = p_value(p)
    return f"p {words}" if words.startswith("<") else f"p = {words}"


def _rival(one: NamedEffect) -> str:
    """The closest rival, and an unrecorded cause, each with its odds."""
    rivals = []
    if one.runner_up is not None:
        rivals.append((f"closest rival {one.runner_up.effect.name}", one.runner_up.log_odds))
    if one.against_drift is not None:
        rivals.append(("a slow drift without a recorded cause", one.against_drift))
    return "".join(f"; {name}, {_odds(odds)}" for name, odds in rivals)


def _odds(log_odds: float) -> str:
    if log_odds < -POLICY.log_odds_alike:
        note = " (it explains the run better)"
    else:
        note = " (not distinguished)" if log_odds < POLICY.log_odds_alike else ""
    return f"odds {odds_words(log_odds)}{note}"


def _nothing_named(result: Diagnosis) -> str:
    """The library effect that comes closest where none is named."""
    if not result.candidates:
        return "none; no effect of the library applies to these touches"
    best = result.candidates[0]
    return f"none; closest by itself {best.effect}, {_chance(best.p_value)}"


def _remains(part: Remainder, repeats: Repeatability) -> str:
    """How much is beyond repeatability, and what it depends on."""
    if not part.is_real:
        return "nothing beyond chance"
    beyond = "beyond repeatability" if repeats.known else "in its strongest pattern"
    words = f"{microns(part.size)} rms {beyond}, {percent(part.share)} of the excess"
    if not part.patterns:
        return f"{words}; it depends on no recorded variable"
    names = dict.fromkeys(noun(v) for p in part.patterns for v in p.variables)
    first = structure_words(part.patterns[0])
    others = [n for n in names if n not in first][:MAX_WRITTEN_OUT]
    also = f" (also {listed(others)})" if others else ""
    it = "it " if part.patterns[0].shape in (Shape.SMOOTH, Shape.DRIVER) else ""
    return f"{words}; {it}{first}{also}"


def repeatability_words(found: Repeatability, scatter: float) -> str:
    """Scatter of the residual (mm) beside that of repeated touches and the stated noise."""
    kinds = (("replicates", found.replicates), ("re-visited places", found.revisits))
    seen: list[Scatter] = []
    repeats = []
    for name, one in kinds:
        if one is not None and one not in seen:
            seen.append(one)
            repeats.append(f"{microns(one.size)} in {name} ({one.dof} degrees of freedom)")
    near = found.neighbours
    near_words = [] if near is None else [f"at most {microns(near.size)} between near neighbours"]
    shown = listed([*repeats, *near_words]) if repeats or near_words else "no touch was repeated"
    return f"stated {microns(found.stated)}; {shown}; scatter of the residual {microns(scatter)}"


def promise_words(after: Promise, before: Promise | None = None) -> str:
    """Errors to expect at other places and at the same touches; and where the model fails."""
    fall = "" if before is None else f"{microns(before.elsewhere)} → "
    fails = [d for d in after.domains if d.ratio > HOLDS_BELOW]
    words = (
        f"{fall}{microns(after.elsewhere)} at other places within the probed range, "
        f"{microns(after.same)} at the same touches"
    )
    if not fails:
        return words
    worst = listed(
        [f"{noun(d.name)} ({digits(d.ratio, 2)} times)" for d in fails[:MAX_WRITTEN_OUT]]
    )
    return f"{words}; blocks left out by {worst} are worse than their uncertainty"


def promise_sentence(
    found: Comparison, promised: Promise, others: Sequence[EffectOfOtherRun] = ()
) -> str:
    """The error of a prediction beside those that its model promised.

    Args:
        promised: Errors to expect when the model was made.
        others: Effects of another run in the model, which the promise excludes.
    """
    limit = BROKEN_PROMISE * promised.elsewhere
    word = "worse than promised" if found.rms > limit else "as good as promised"
    if found.where and found.rms <= limit:
        word += " over all touches, but not where the model fails"
    why = ""
    # a noise that was stated too large is no uncertainty of the model
    stated = found.repeatability.stated
    of_model = float(np.sqrt(max(found.expected**2 - stated**2, 0.0)))
    expected = float(np.hypot(of_model, min(stated, found.scatter)))
    if expected > limit:
        why = (
            f" At these touches, which differ from those of the model, its uncertainty leads to "
            f"an expected error of {microns(expected)}."
        )
    again = float(np.linalg.norm([promised.elsewhere, *(one.share for one in others)]))
    if again > limit:
        names = listed([title_of(one.effect).text for one in others], "or a")
        why += (
            f" If this run had a {names} of the same size as that run, an error of "
            f"{microns(again)} would be expected."
        )
    return (
        f"The prediction is {word}: {microns(found.rms)}. Promised when the model was made: "
        f"{promise_words(promised)}.{why}"
    )
