"""The verdict of a diagnosis in sentences: effects found, residuals, what to do."""

import math
from collections.abc import Sequence

from matstd.diagnosis.answer import Diagnosis, Step, Verdict, acts_as_instrument
from matstd.diagnosis.fit import Fit
from matstd.diagnosis.laws import Learning
from matstd.diagnosis.policy import POLICY
from matstd.diagnosis.remarks import OffTogether
from matstd.report.effects import DOUBTS, class_words, words_of_name
from matstd.report.laws import held_out_sentence, instead_sentence, law_sentence, rival_sentence
from matstd.report.numbers import digits, microns
from matstd.report.words.diagnosis_words import (
    far_setups,
    noise_words,
    sizes,
    stated_noise,
    structure_clause,
)
from matstd.report.words.remark_words import off_sentence
from matstd.twin.units import DEG
from matstd.twin.words import few, listed

NAMED_ALIKE = 3  # effects of the library that are named as not distinguished from a first one
PERIODS_NAMED = 4  # indistinguishable periods that are named, the longest ones
UNREPORTED_EXCESS = 0.1
"""Excess over the stated noise that is not reported: half a per cent of its size."""

EXPLAINING_SHARE = 0.5
"""Share of the mean square beyond the stated noise that a pattern must have to explain it."""

_NUMBERS = {1: 3, 2: 2, 3: 1}
"""Numbers of an effect in the verdict by the number of effects; of more effects only the names."""


def excess(fit: Fit) -> float:
    """Root mean square of the residual beyond the stated noise, mm."""
    stated = stated_noise(fit.run)
    return stated * math.sqrt(max(fit.noise.factor**2 - 1.0, 0.0))


def _unexplained(diagnosis: Diagnosis) -> str:
    """Size of the residual that is not noise: beyond the stated noise, or as a part of it.

    Scatter without a pattern may be noise that was stated too small.
    """
    fit, stated = diagnosis.fit, stated_noise(diagnosis.run)
    beyond = excess(fit)
    share = min(max((s.share for s in diagnosis.left), default=1.0), 1.0)
    whole = stated * fit.noise.factor
    if whole**2 * share < EXPLAINING_SHARE * beyond**2 or beyond < UNREPORTED_EXCESS * stated:
        return (
            f"{microns(whole * math.sqrt(share))} of the residual of {microns(whole)} rms "
            f"(stated noise: {microns(stated)})"
        )
    return f"{microns(beyond)} rms beyond the stated noise of {microns(stated)}"


def _fall(diagnosis: Diagnosis) -> str:
    """The error to expect, which falls: of what predicts, so elsewhere first."""
    before, after = diagnosis.promise_before, diagnosis.promise
    is_chosen = diagnosis.choice is not None and diagnosis.standing is diagnosis.fit
    if is_chosen and not diagnosis.fit.test_rows.any():
        return (
            "the error of blocks left out, with the choice repeated without each, falls from "
            f"{microns(before.same)} to {microns(after.same)}"
        )
    verb = "falls" if after.elsewhere < before.elsewhere else "rises"
    return (
        f"the error to expect at other places {verb} from {microns(before.elsewhere)} to "
        f"{microns(after.elsewhere)} (at the same touches: {microns(before.same)} to "
        f"{microns(after.same)})"
    )


def _alike(step: Step, places: Sequence[float]) -> str:
    """Periods that cannot be distinguished from that of an effect, and where to measure.

    Args:
        places: Readings of the axis that would distinguish them, mm; empty where none would.
    """
    alike = step.confusion.alike if step.confusion else None
    if alike is None:
        return ""
    beyond = [f"{p:.3g}" for p in alike.beyond[:PERIODS_NAMED]]
    most = PERIODS_NAMED if len(alike.periods) > PERIODS_NAMED + 1 else None
    longest = [f"{p:.4g}" for p in alike.periods[:most]]
    more = len(alike.periods) - len(longest)
    unit, finer = ("", "higher") if alike.is_harmonic else (" mm", "shorter")
    others = (
        f"{', '.join(longest)}{unit} or one of {more} {finer} ones"
        if more > 0
        else f"{listed(longest, 'or')}{unit}"
    )
    what_else = f"{'harmonic' if alike.is_harmonic else 'a period of'} {others}" if longest else ""
    if beyond:
        also = f"{'a period' if not longest else 'one'} of {listed(beyond, 'or')} mm"
        what_else += f"{', nor from ' if longest else ''}{also}, longer than were searched"
    at = f"with steps of {alike.step:g} mm" if alike.step else "with these targets"
    why = f" (chosen for the stated pitch of {alike.pitch:g} mm)" if alike.pitch else ""
    where = listed([f"{p:g}" for p in places])
    reading = "°" if alike.is_harmonic else " mm"
    what = f"; to distinguish them, measure at {alike.axis} {where}{reading}" if places else ""
    return f"{at} it cannot be distinguished from {what_else}{why}{what}"


def _places(diagnosis: Diagnosis, step: Step) -> list[float]:
    """Three readings, far apart, that distinguish the periods of an effect; mm or degrees."""
    alike = step.confusion.alike if step.confusion else None
    name = step.effect.name if step.effect is not None else ""
    for plan in diagnosis.plans if alike is not None else ():
        if plan.periods_of == name and alike is not None:
            unit = DEG if alike.is_harmonic else 1.0
            readings = sorted({round(q / unit, 2) for q in plan.touches.reading(alike.axis)})
            return sorted({readings[0], readings[len(readings) // 2], readings[-1]})
    return []


def _added(diagnosis: Diagnosis, step: Step, most: int) -> str:
    """An effect with its leading numbers and its rivals."""
    touches = diagnosis.run.touches
    instrument = ""
    if step.effect is not None and acts_as_instrument(step.effect, touches):
        words = touches.instrument.value.replace("-", " ")
        instrument = f"the {words} itself may be the cause: it is the same at every target"
    clauses = [
        sizes(step, most) if most else "",
        _alike(step, _places(diagnosis, step)),
        instrument,
    ]
    return class_words(step, [clause for clause in clauses if clause])


def _covered(diagnosis: Diagnosis) -> str:
    """A pattern within the stated noise, as a sentence; empty where there is none."""
    if not diagnosis.left or diagnosis.parts.remains.is_real:
        return ""
    found = max(diagnosis.left, key=lambda s: s.share)
    size = stated_noise(diagnosis.run) * diagnosis.fit.noise.factor * math.sqrt(min(found.share, 1))
    return (
        f" Within the stated noise, {microns(size)} of the residual follow a pattern: "
        f"{structure_clause(found)}."
    )


def verdict_sentence(diagnosis: Diagnosis) -> str:
    """The verdict with numbers and standard uncertainties; a wrong description is in it.

    First stand set-ups that are not where the file states them, and features that are off as a
    whole or in part: no part of the machine.
    """
    off = [off_sentence(r) for r in diagnosis.remarks if isinstance(r, OffTogether)]
    first = [*far_setups(diagnosis.run), *(f"{words}." for words in off)]
    return " ".join([*first, _of_machine(diagnosis)])


def _of_machine(diagnosis: Diagnosis) -> str:
    """The verdict on the machine and its description."""
    far = [row for row in diagnosis.parts.geometry.beyond if row.is_far]
    if not far:
        return _verdict_alone(diagnosis)
    sizes = listed([f"{r.symbol} is {digits(r.times_usual, 2)} times its usual size" for r in far])
    return f"{_verdict_alone(diagnosis)} The machine file or the set-up is wrong: {sizes}."


def _verdict_alone(diagnosis: Diagnosis) -> str:
    most = _NUMBERS.get(len(diagnosis.steps) - 1, 0)
    steps = diagnosis.steps[1:]
    named = [_added(diagnosis, s, most) for s in steps if s.is_named]
    certain = {n.effect.name for n in diagnosis.parts.headline}
    others = [s for s in steps if not s.is_named]
    found = [_added(diagnosis, s, most) for s in others if s.effect and s.effect.name in certain]
    doubtful = len(others) - len(found)
    laws = diagnosis.laws if diagnosis.laws is not None and diagnosis.laws.laws else None
    if laws is not None and (diagnosis.withdrawn or diagnosis.verdict is Verdict.UNEXPLAINED):
        return _of_law(diagnosis, laws, [*named, *found])
    also = f" Added by name: {'; '.join(named)}." if named else ""
    them = "it" if len(steps) == 1 else "them"
    them += "" if laws is None else " and the law" if len(laws.laws) == 1 else " and the laws"
    if diagnosis.verdict is Verdict.MISSING:
        what = "one effect" if len(found) == 1 else f"{len(found)} effects"
        more = f" ({_plural(doubtful)} not certain or too small to name)" if doubtful else ""
        return (
            f"The model lacks {what}: {'; '.join(found)}{more}.{also} With {them} "
            f"{_fall(diagnosis)}; the noise is "
            f"{noise_words(diagnosis.fit)}.{_also_left(diagnosis)}{_covered(diagnosis)}"
        )
    if diagnosis.verdict is Verdict.UNEXPLAINED:
        return _unexplained_sentence(diagnosis, [*named, *found])
    if diagnosis.verdict is Verdict.UNDECIDED and doubtful:
        doubts = {n.effect.name: n.doubt for n in diagnosis.parts.named}
        one = doubts[others[0].name] if doubtful == 1 else None
        why = "none is certain by itself" if one is None else f"it is {DOUBTS[one]}"
        return (
            f"This run cannot decide: {_plural(doubtful)} would reduce the error, but {why}. "
            f"With {them} {_fall(diagnosis)}.{also}"
        )
    if diagnosis.verdict is Verdict.UNDECIDED:
        return _undecided_sentence(diagnosis)
    fall = f" With {them} {_fall(diagnosis)}." if named else ""
    return (
        f"No {'further ' if named else ''}effect is missing that this run could show: the error "
        f"to expect at other places is {microns(diagnosis.promise.elsewhere)} (at the same "
        f"touches: {microns(diagnosis.promise.same)}), and the noise is "
        f"{noise_words(diagnosis.fit)}.{also}{fall}{_covered(diagnosis)}"
    )


def _plural(count: int) -> str:
    return "one effect" if count == 1 else f"{count} effects"


def _of_law(diagnosis: Diagnosis, laws: Learning, added: Sequence[str]) -> str:
    """The laws, the names that they withdraw, and the error with them.

    Where the library explains as well or better, its effects come first.

    Args:
        added: Effects that stand beside them.
    """
    what = "a law that the library does" if len(laws.laws) == 1 else "laws that the library does"
    beside = f"Beside {'it' if len(laws.laws) == 1 else 'them'}: {'; '.join(added)}."
    first = f"The model lacks {what} not have: {_laws(laws)}."
    if laws.of_library:
        each = [_of_library(diagnosis, name) for name in laws.of_library]
        first = (
            f"The model lacks {_plural(len(each))}: {'; '.join(each)}. Second choice, a law "
            f"that explains no more: {_laws(laws)}."
        )
    said = [
        first,
        *(rival_sentence(one) for one in laws.laws if not laws.of_library),
        instead_sentence(laws),
        beside if added else "",
        held_out_sentence(laws),
        f"The noise is {noise_words(laws.after)}.",
    ]
    return " ".join(filter(None, said))


def _of_library(diagnosis: Diagnosis, name: str) -> str:
    """An effect of the library, with those that alone explain the run about as well."""
    own = next((c.log_odds for c in diagnosis.candidates if c.effect == name), math.inf)
    alike = [
        c.effect
        for c in diagnosis.candidates
        if c.effect != name and c.log_odds > own - POLICY.log_odds_alike
    ]
    words = words_of_name(name, diagnosis.run.touches.chain)
    return f"{words}, or {few(alike, NAMED_ALIKE, 'or')}, not distinguished" if alike else words


def _laws(laws: Learning) -> str:
    return "; ".join(law_sentence(laws, one).removesuffix(".") for one in laws.laws)


def _also_left(diagnosis: Diagnosis) -> str:
    """What remains beside the names, as a sentence; empty for nothing."""
    left = diagnosis.parts.remains
    if not left.is_real:
        return ""
    what = (
        structure_clause(left.patterns[0]) if left.patterns else "it follows no recorded variable"
    )
    them = "it" if len(diagnosis.steps) == 2 else "them"
    learnt = "" if not diagnosis.laws or not diagnosis.laws.laws else f"; {_laws(diagnosis.laws)}"
    return f" Beside {them}, {microns(left.size)} rms remain: {what}{learnt}."


def _unexplained_sentence(diagnosis: Diagnosis, added: Sequence[str]) -> str:
    """The size and the pattern of a residual without a name, and the nearest effects."""
    words = "; ".join(
        dict.fromkeys(structure_clause(d.structure) for d in diagnosis.depends_on[:2])
    )
    what = f" Added: {'; '.join(added)}; {_fall(diagnosis)}." if added else ""
    rest = "" if diagnosis.nearest else " that no effect of the library explains"
    return (
        f"A residual remains{rest}: {_unexplained(diagnosis)}. It is not noise: "
        f"{words or 'it varies with no recorded variable'}.{what}{_nearest(diagnosis)}"
    )


def _nearest(diagnosis: Diagnosis) -> str:
    """The nearest effect, with the error it would leave; empty for none."""
    if not diagnosis.nearest:
        return ""
    best, *others = diagnosis.nearest
    before, after = microns(diagnosis.fit.test_rms), microns(best.test_rms)
    also = f"; next: {listed([o.effect for o in others])}" if others else ""
    return (
        f" The nearest effect is {best.effect} (p = {best.p_value:.0e}), which reduces the error "
        f'of held-out touches from {before} to {after}; add it with --add "{best.effect}"{also}.'
    )


def _undecided_sentence(diagnosis: Diagnosis) -> str:
    """Remark that noise alone would explain the run if it were large enough."""
    noise = diagnosis.fit.noise
    lines = [str(line) for line in sorted(diagnosis.run.line[diagnosis.repeat])]
    shown = (
        "no touch was repeated"
        if noise.replicates is None
        else f"{noise.replicates_dof} repeated touches show {digits(noise.replicates, 2)} times it"
    )
    size = noise.factor * stated_noise(diagnosis.run)
    return (
        "This run cannot decide whether an effect is missing: the noise would have to be "
        f"{microns(size)}, {digits(noise.factor, 2)} times the stated one, and {shown}. Repeat the "
        f"touches of lines {listed(lines)} three times each under unchanged conditions; a residual "
        "that recurs is not noise."
    )
