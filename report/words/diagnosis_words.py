"""What is said of a run: verdicts with numbers, sizes with uncertainties, what is left."""

import math
from collections.abc import Mapping, Sequence

import numpy as np

from matstd.diagnosis.answer import Comparison, Detectable, Diagnosis, Step, Verdict
from matstd.diagnosis.fit import SINE, Fit, Reported, Role
from matstd.diagnosis.remarks import OfAnotherRun
from matstd.diagnosis.residual import Condition, Shape, Side, Structure
from matstd.report.effects import class_words, words_of_name
from matstd.report.numbers import condition, digits, noun, span, unit_words, with_uncertainty
from matstd.report.words.open_words import microns, nearest_clause, stated_noise, undecided_sentence
from matstd.report.words.remark_words import memory_words
from matstd.twin.library import title_of
from matstd.twin.numbers import rms
from matstd.twin.units import DEG, UM
from matstd.twin.words import listed

_WORDS = {
    "rms": "rms that it explains",
    "peak_to_valley": "peak to valley",
    "length": "correlation length",
    "tau": "time constant",
    "cycles": "time constant in cycles",
    "step": "per step of",
    "reversal_on_average": "reversal on average",
    "reversal_at_most": "reversal at most",
}

_GROUPS = ("feature", "pose", "setup")
"""Columns that only tell rows apart: nothing grows with them."""

PERIODS_TOLD = 4
"""Periods that look alike that are told one by one, the longest ones."""

WITHIN = 0.1
"""Excess over stated noise below which nothing stands out of it: half a per cent of its size."""

HALF = 0.5
"""Share of the square beyond the stated noise that a pattern must hold to be the reason for it."""

ALL_TOLD = 7
"""Numbers of an effect that are told one by one; of more only the size is."""


_NUMBERS = {1: 3, 2: 2, 3: 1}
"""Numbers of an effect in the verdict by the number of effects; of more effects only the names."""


def named_value(reported: Reported) -> tuple[str, str]:
    """Name and value of a number of an effect as a reader sees them: `time constant`, `42 ± 3 min`.

    Example:
        >>> named_value(Reported("tau", "min", 42.07, 3.32, 60.0, Role.INNER))
        ('time constant', '42.1 ± 3.3 min')
        >>> named_value(Reported("instant", "s", 7083.0, None, 1.0, Role.INNER))
        ('instant', '1.97 h')
        >>> named_value(Reported("tau", "min", 2.0, None, 60.0, Role.INNER, bound=-1))
        ('time constant', 'at most 2.00 min')
    """
    words = _WORDS.get(reported.quantity, reported.quantity).replace("_", " ")
    if reported.bound:
        side = "at most" if reported.bound < 0 else "at least"
        return words, f"{side} {digits(reported.value, 3)} {unit_words(reported.unit)}".rstrip()
    if reported.unit == "s" and reported.u is None:
        return words, span(reported.value)
    if reported.quantity == "length" and not reported.unit:
        return words, f"{reported.value:.0%} of the travel"
    if reported.quantity == "harmonic":
        return words, f"{reported.value:g} a turn"
    return words, with_uncertainty(reported.value, reported.u, unit_words(reported.unit))


_ORDER = (Role.SIZE, Role.INNER, Role.COEFFICIENT)


def values(step: Step) -> list[tuple[str, str]]:
    """Numbers of an added effect as a reader sees them, its size first.

    Of an effect with many coefficients only what sums them up and its inner parameters are told.
    """
    return number_words(step.reported)


def number_words(reported: Sequence[Reported]) -> list[tuple[str, str]]:
    """The same of the numbers themselves, as a model file keeps them."""
    sines = [r for r in reported if r.quantity.startswith(SINE)]
    told = sorted(reported, key=lambda r: _ORDER.index(r.role))
    is_curve = any(r.quantity == "peak_to_valley" for r in told)
    if is_curve or sines or len(told) > ALL_TOLD:
        told = [r for r in told if r.role is not Role.COEFFICIENT]
    if is_curve:  # how smooth it was taken to be is in the files
        told = [r for r in told if r.quantity != "length"]
    out = [named_value(r) for r in told if (r.quantity, r.value) != ("step", 1.0)]
    return [*out, *([_sine_words(sines)] if sines else [])]


def _sine_words(sines: Sequence[Reported]) -> tuple[str, str]:
    """Amplitudes of the sines of one period in one clause, their uncertainty behind them."""
    u = max(r.u or 0.0 for r in sines)
    each = ", ".join(with_uncertainty(r.value, u, "").split(" ± ")[0] for r in sines)
    least = digits(u, 2)
    return (
        f"in sines of 1/1 to 1/{len(sines)} of it",
        f"{each} (± {least}) {unit_words(sines[0].unit)}",
    )


def sizes(step: Step, most: int) -> str:
    """The leading numbers of an added effect in one clause, its size first."""
    return ", ".join(" ".join(value) for value in values(step)[:most])


def noise_words(fit: Fit) -> str:
    """The noise as found, and as stated where that is another."""
    stated = stated_noise(fit.run)
    found = stated * fit.noise.factor
    remembers = fit.memory is not None and fit.memory.is_filtered
    after = f" and remembers ({_memory(fit)})" if remembers else ""
    if fit.noise.is_wrongly_stated:
        return f"{microns(found)} (stated: {microns(stated)}){after}"
    return f"{microns(stated)}{after}"


def excess(fit: Fit) -> float:
    """Root mean square of what is left beyond the stated noise, mm."""
    stated = stated_noise(fit.run)
    return stated * math.sqrt(max(fit.noise.factor**2 - 1.0, 0.0))


def _left(diagnosis: Diagnosis) -> str:
    """How much is left that is no noise, as a clause: beyond the stated noise, or of what is left.

    What follows no pattern may be noise that was stated too small.
    """
    fit, stated = diagnosis.fit, stated_noise(diagnosis.run)
    beyond = excess(fit)
    share = min(max((s.share for s in diagnosis.left), default=1.0), 1.0)
    whole = stated * fit.noise.factor
    if whole**2 * share < HALF * beyond**2 or beyond < WITHIN * stated:
        return (
            f"of {microns(whole)} rms that are left (noise stated: {microns(stated)}) "
            f"{microns(whole * math.sqrt(share))}"
        )
    return f"{microns(beyond)} rms beyond the stated noise of {microns(stated)}"


def region_words(conditions: Sequence[Condition]) -> str:
    """Conditions as a reader says them, `B > 60 deg and time < 40 min`."""
    parts = []
    for name in dict.fromkeys(c.variable for c in conditions):
        own = {c.side: c.bound for c in conditions if c.variable == name}
        if Side.IS in own:
            parts.append(f"{'in set-up' if name == 'setup' else 'on'} {own[Side.IS]}")
            continue
        low, high = own.get(Side.FROM, -math.inf), own.get(Side.BELOW, math.inf)
        parts.append(condition(name, float(low), float(high)))
    return " and ".join(parts)


def structure_words(found: Structure) -> str:
    """What a residual does, as it stands in a table: `varies with X and Y, along Z`."""
    names = listed([noun(name) for name in found.variables])
    along = "the normal" if found.direction == "normal" else found.direction
    match found.shape:
        case Shape.SMOOTH if found.variables[0] in _GROUPS:
            return f"differs from {names} to {names}, along {along}"
        case Shape.SMOOTH:
            return f"varies with {names}, along {along}"
        case Shape.WAVE:
            return f"a wave in time, every {span(found.period)}, along {along}"
        case Shape.NEIGHBOURS:
            return f"neighbours in {names} agree"
        case Shape.CROWD:
            return f"gross errors crowd together in {names}"


def structure_clause(found: Structure) -> str:
    """The same as a clause that stands after a colon."""
    it = "it " if found.shape is Shape.SMOOTH else ""
    return it + structure_words(found)


def _fall(diagnosis: Diagnosis) -> str:
    if diagnosis.choice is not None and not diagnosis.fit.test_rows.any():
        first, best = diagnosis.choice.rules[0], diagnosis.choice.best
        return (
            f"the plain error of blocks left out, the choice made anew without each, falls from "
            f"{microns(first.error)} to {microns(best.error)}"
        )
    return (
        f"the error of held-out touches falls from {microns(diagnosis.start.test_rms)} to "
        f"{microns(diagnosis.fit.test_rms)}"
    )


def _alike(step: Step, places: Sequence[float]) -> str:
    """What a period cannot be told from, and where to measure to tell them apart.

    Args:
        step: With an effect whose period others look like; others have nothing said.
        places: Readings of the axis that would tell them apart, mm; empty for none on offer.
    """
    alike = step.confusion.alike if step.confusion else None
    if alike is None:
        return ""
    told_of = PERIODS_TOLD if len(alike.periods) > PERIODS_TOLD + 1 else None
    longest = [f"{p:.4g}" for p in alike.periods[:told_of]]
    more = len(alike.periods) - len(longest)
    unit, finer = ("", "higher") if alike.is_harmonic else (" mm", "shorter")
    told = (
        f"{', '.join(longest)}{unit} or one of {more} {finer} ones"
        if more > 0
        else f"{listed(longest, 'or')}{unit}"
    )
    what_else = f"{'harmonic ' if alike.is_harmonic else ''}{told}"
    at = f"with steps of {alike.step:g} mm" if alike.step else "with targets that stand so"
    why = f" (named for the stated pitch of {alike.pitch:g} mm)" if alike.pitch else ""
    where = listed([f"{p:g}" for p in places])
    reading = "°" if alike.is_harmonic else " mm"
    what = f": measure at {alike.axis} {where}{reading}" if places else ""
    return f"{at} it could as well be {what_else}{why}{what}"


def _places(diagnosis: Diagnosis, step: Step) -> list[float]:
    """Three readings, far apart, of the plan that tells the periods of an effect; mm or degrees."""
    alike = step.confusion.alike if step.confusion else None
    name = step.effect.name if step.effect is not None else ""
    for plan in diagnosis.plans if alike is not None else ():
        if plan.periods_of == name and alike is not None:
            unit = DEG if alike.is_harmonic else 1.0
            readings = sorted({round(q / unit, 2) for q in plan.touches.reading(alike.axis)})
            return sorted({readings[0], readings[len(readings) // 2], readings[-1]})
    return []


def _added(diagnosis: Diagnosis, step: Step, most: int) -> str:
    """An effect with its leading numbers, and whether another one would do as well."""
    told = [sizes(step, most) if most else "", _alike(step, _places(diagnosis, step))]
    return class_words(step, [clause for clause in told if clause])


def _them(steps: Sequence[Step]) -> str:
    return "it" if len(steps) == 1 else "them"


def _covered(diagnosis: Diagnosis) -> str:
    """A pattern that the stated noise covers, as a sentence; empty where there is none."""
    if not diagnosis.left:
        return ""
    found = max(diagnosis.left, key=lambda s: s.share)
    size = stated_noise(diagnosis.run) * diagnosis.fit.noise.factor * math.sqrt(min(found.share, 1))
    return (
        f" Of what is left, which the stated noise covers, {microns(size)} are none: "
        f"{structure_clause(found)}."
    )


def verdict_sentence(diagnosis: Diagnosis) -> str:
    """The verdict in one plain sentence, with numbers and standard uncertainties."""
    most = _NUMBERS.get(len(diagnosis.steps) - 1, 0)
    steps = diagnosis.steps[1:]
    named = [_added(diagnosis, s, most) for s in steps if s.is_named]
    found = [_added(diagnosis, s, most) for s in steps if not s.is_named]
    also = f" Added by name: {'; '.join(named)}." if named else ""
    if diagnosis.verdict is Verdict.MISSING:
        what = "one effect" if len(found) == 1 else f"{len(found)} effects"
        return (
            f"The model lacks {what}: {'; '.join(found)}.{also} With {_them(steps)} "
            f"{_fall(diagnosis)}; the noise is {noise_words(diagnosis.fit)}.{_covered(diagnosis)}"
        )
    if diagnosis.verdict is Verdict.UNEXPLAINED:
        words = "; ".join(
            dict.fromkeys(structure_clause(d.structure) for d in diagnosis.depends_on[:2])
        )
        was = "was" if len(steps) == 1 else "were"
        what = f" Put in {was} {'; '.join([*named, *found])}: {_fall(diagnosis)}." if steps else ""
        rest = "" if diagnosis.nearest else " that no effect of the library accounts for"
        return (
            f"Something is left{rest}: {_left(diagnosis)}. It is not noise: "
            f"{words or 'it varies with nothing that was recorded'}.{what}"
            f"{nearest_clause(diagnosis)}"
        )
    if diagnosis.verdict is Verdict.UNDECIDED:
        return undecided_sentence(diagnosis)
    fall = f" With {_them(steps)} {_fall(diagnosis)}." if named else ""
    return (
        f"Nothing{' more' if named else ''} is missing that this run could have shown: the error "
        f"of held-out touches is {microns(diagnosis.fit.test_rms)}, and the noise is "
        f"{noise_words(diagnosis.fit)}.{also}{fall}{_covered(diagnosis)}"
    )


def scanned_sentence(found: Sequence[Detectable]) -> str:
    """Where periods, time constants and the like were looked for; "" where there is none."""
    ranges: dict[tuple[str, str], tuple[float, float]] = {}
    told = (s for d in found if d.size is not None for s in d.scanned)
    for scan in (s for s in told if s.unit or s.quantity == "harmonic"):
        key = (_WORDS.get(scan.quantity, scan.quantity), scan.unit)
        low, high = ranges.get(key, (scan.low, scan.high))
        ranges[key] = (min(low, scan.low), max(high, scan.high))
    each = [
        f"{name}s of {digits(low)} to {digits(high)}{f' {unit_words(unit)}' if unit else ''}"
        for (name, unit), (low, high) in sorted(ranges.items())
    ]
    return f"Looked for were {listed(each)}; outside, this run says nothing." if each else ""


def comparison_sentence(found: Comparison) -> str:
    """What a model leaves of a run, in plain words with numbers."""
    made = "predicts" if found.is_prediction else "fitted to the run explains"
    worst = found.worst
    left = microns(found.rms)
    is_better = found.rms <= found.rms_measured
    text = (
        f"Of {microns(found.rms_measured)} rms that were measured the model {made} "
        f"{f'all but {left}' if is_better else f'nothing: {left} are left'}; the noise is stated "
        f"as {microns(stated_noise(found.run))}, chi-square per degree of freedom is "
        f"{digits(found.chi2_ratio)}, and the worst touch (line {found.run.line[worst]}) is off by "
        f"{microns(float(found.residual[worst]))}, "
        f"{digits(abs(float(found.normalised[worst])), 2)} times its uncertainty."
    )
    if not found.structure:
        return f"{text} What is left looks like noise."
    return f"{text} What is left is not noise: {structure_clause(found.structure[0])}."


BROKEN = 1.1
"""Error over what was promised from which a promise is called broken; the figures themselves
scatter by a few per cent."""


def promise_sentence(
    found: Comparison, promised: float, others: Sequence[OfAnotherRun] = ()
) -> str:
    """The error of a prediction beside the one that its model promised (mm), in plain words.

    Args:
        others: What the model has of another run: the promise holds where nothing like it happens.
    """
    word = "worse than" if found.rms > BROKEN * promised else "as good as"
    expected = rms(found.u[found.counted])
    elsewhere = (
        f" At these touches, which are not those that it was made from, {microns(expected)} "
        "are to be expected of its uncertainty."
        if expected > BROKEN * promised
        else ""
    )
    again = float(np.linalg.norm([promised, *(one.share for one in others)]))
    elsewhere += (
        f" Where this run had a {listed([title_of(one.effect).text for one in others], 'or a')} as "
        f"large as there, {microns(again)} would be expected."
        if again > BROKEN * promised
        else ""
    )
    return (
        f"That is {word} was promised: {microns(found.rms)} beside {microns(promised)}, the error "
        f"of rows that the model had not seen when it was made.{elsewhere}"
    )


def figures(fit: Fit) -> tuple[str, str, str]:
    """Fitted and held-out error, µm, and chi-square per degree of freedom, as in all tables."""
    return f"{fit.rms / UM:.3f}", f"{fit.test_rms / UM:.3f}", digits(fit.noise.chi2_ratio)


def learnt_lines(fit: Fit, told: Mapping[str, Sequence[Reported]]) -> list[str]:
    """What was told of the fit that a model was learnt by: its figures, then its effects.

    Args:
        fit: Made again from the model.
        told: Numbers of effects as the model file keeps them, by name.
    """
    rms, held_out, chi2 = figures(fit)
    first = (
        f"As it was learnt from these very rows: fitted {rms} µm, held out {held_out} µm, "
        f"chi-square per degree of freedom {chi2}."
    )
    sizes = {name: ", ".join(" ".join(v) for v in number_words(r)) for name, r in told.items()}
    chain = fit.run.touches.chain
    return [first, *(f"{words_of_name(name, chain)}: {w}" for name, w in sizes.items() if w)]


def _memory(fit: Fit) -> str:
    """What the noise of a fit remembers; empty for white noise."""
    memory = fit.memory
    if memory is None:
        return ""
    return memory_words(memory.correlation, memory.step, memory.by_place)
