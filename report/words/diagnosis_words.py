"""Sentences on a run: verdicts with numbers, sizes with uncertainties, residuals."""

import math
from collections.abc import Mapping, Sequence

import numpy as np

from matstd.diagnosis.answer import Comparison, Detectable, Step
from matstd.diagnosis.fit import SINE_PREFIX, Fit, Reported, Role
from matstd.diagnosis.residual import Condition, Region, Shape, Side, Structure, Wrong
from matstd.report.effects import words_of_name
from matstd.report.numbers import (
    condition,
    digits,
    microns,
    noun,
    p_value,
    plural,
    signed,
    span,
    unit_words,
    with_uncertainty,
)
from matstd.report.words.remark_words import memory_words
from matstd.twin.numbers import rms
from matstd.twin.record import FAR_SHIFT, FAR_TURN, Moved, Run
from matstd.twin.thermal import CYCLE, PROGRESS
from matstd.twin.units import DEG, UM, URAD
from matstd.twin.words import listed

_WORDS = {
    "rms": "rms over the touches that it moves",
    "peak_to_valley": "peak to valley",
    "length": "correlation length",
    "tau": "time constant",
    "cycles": "time constant in cycles",
    "reversal_on_average": "reversal on average",
    "reversal_at_most": "reversal at most",
}

_GROUPS = ("feature", "pose", "setup")  # columns that number rows without an order

_PARTS = {
    "bias": "the reading along the normal",
    **{f"shift-{c}": f"the place of the standard along {c} of the table" for c in "xyz"},
}
"""Carriers of an error that are no component of an axis."""

TURNS = {"a quarter turn": 90.0, "half a turn": 180.0}
NEARLY_WHOLE = 2.0
"""Turns of a standard that have names, degrees, and how near to them one is that is called so."""
ALONG_AXIS = 0.99  # part of the direction of a rotation along an axis that is named for it

MOST_NAMED_CARRIERS = 4  # carriers that are named beside the first
ALL_NUMBERS = 7  # numbers of an effect that are written out; of more, only those that sum them up


def named_value(reported: Reported) -> tuple[str, str]:
    """Name and value of a number of an effect: `time constant`, `42 ± 3 min`.

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
        return words, f"{reported.value:g} per turn"
    return words, with_uncertainty(reported.value, reported.u, unit_words(reported.unit))


_ORDER = (Role.SIZE, Role.INNER, Role.COEFFICIENT)


def values(step: Step) -> list[tuple[str, str]]:
    """Numbers of an added effect, its size first.

    Many coefficients are replaced by the numbers that sum them up.
    """
    return number_words(step.reported, step.name)


def number_words(reported: Sequence[Reported], name: str) -> list[tuple[str, str]]:
    """The same from the numbers that a model file keeps of an effect of this name."""
    sines = [r for r in reported if r.quantity.startswith(SINE_PREFIX)]
    shown = sorted(reported, key=lambda r: _ORDER.index(r.role))
    # what sums up the coefficients, or is reported in place of final values beyond the run
    is_curve = any(r.quantity == "peak_to_valley" or "change_at" in r.quantity for r in shown)
    if is_curve or sines or len(shown) > ALL_NUMBERS:
        shown = [r for r in shown if r.role is not Role.COEFFICIENT]
    if is_curve:  # its assumed smoothness is in the files
        shown = [r for r in shown if r.quantity != "length"]
    per = next((_per(r.value, name) for r in shown if r.quantity == "step"), "")
    out = [
        (word, f"{value}{per}" if word == "amplitude" else value)
        for word, value in (named_value(r) for r in shown if r.quantity != "step")
    ]
    return [*out, *([_sine_words(sines)] if sines else [])]


def _per(step: float, name: str) -> str:
    """Of what change of its drive an amplitude is: ` per cycle`, or ` per step of 10`.

    The unit of a user's column is in its name.
    """
    if any(column in name for column in (CYCLE, PROGRESS)):
        return " per cycle" if step == 1.0 else f" per {step:g} cycles"
    return f" per step of {step:g}"


def _sine_words(sines: Sequence[Reported]) -> tuple[str, str]:
    """Amplitudes of the harmonics of one period with their common uncertainty."""
    u = max(r.u or 0.0 for r in sines)
    each = ", ".join(with_uncertainty(r.value, u, "").split(" ± ")[0] for r in sines)
    return (
        f"amplitudes of its harmonics 1 to {len(sines)}",
        f"{each} (± {digits(u, 2)}) {unit_words(sines[0].unit)}",
    )


def sizes(step: Step, most: int) -> str:
    """The leading numbers of an added effect in one clause, its size first."""
    return ", ".join(" ".join(value) for value in values(step)[:most])


def stated_noise(run: Run) -> float:
    """Stated standard uncertainty of a touch, root mean square, mm."""
    return rms(run.u)


def noise_words(fit: Fit) -> str:
    """The noise as estimated, with the stated one where that is another."""
    stated = stated_noise(fit.run)
    found = stated * fit.noise.factor
    remembers = fit.memory is not None and fit.memory.is_filtered
    after = f" and is correlated ({_memory(fit)})" if remembers else ""
    if fit.noise.is_wrongly_stated:
        return f"{microns(found)} (stated: {microns(stated)}){after}"
    return f"{microns(stated)}{after}"


def region_words(conditions: Sequence[Condition]) -> str:
    """Conditions in words, `B > 60 deg and time < 40 min`."""
    parts = []
    for name in dict.fromkeys(c.variable for c in conditions):
        own = {c.side: c.bound for c in conditions if c.variable == name}
        if Side.IS in own:
            parts.append(f"{'in set-up' if name == 'setup' else 'on'} {own[Side.IS]}")
            continue
        low, high = own.get(Side.FROM, -math.inf), own.get(Side.BELOW, math.inf)
        parts.append(condition(name, float(low), float(high)))
    return " and ".join(parts)


def wrong_words(wrong: Wrong) -> str:
    """The error that is off in a region, and by how much: `EBY off by +14.20 ± 0.61 µrad`."""
    unit, name = (URAD, "µrad") if wrong.is_angular else (UM, "µm")
    carrier = _PARTS.get(wrong.carrier, wrong.carrier)
    return f"{carrier} off by {signed(wrong.size / unit, wrong.u / unit, name)}"


def carriers_alike(wrong: Wrong) -> str:
    """Other errors that may be it: `EBX, EBZ or 3 others`."""
    names = [_PARTS.get(name, name) for name in wrong.alike]
    if len(names) > MOST_NAMED_CARRIERS:
        names = [
            *names[: MOST_NAMED_CARRIERS - 1],
            f"{len(names) - MOST_NAMED_CARRIERS + 1} others",
        ]
    return listed(names, "or")


def region_sentence(region: Region) -> str:
    """A region: the error and by how much it is off, or the scatter, and where."""
    where = region_words(region.conditions)
    where = where if where.startswith(("on ", "in ")) else f"where {where}"
    if region.wrong is None:
        what = f"residuals are larger than elsewhere: {microns(region.rms)} rms"
    else:
        what, alike = wrong_words(region.wrong), carriers_alike(region.wrong)
        where += f" (or {alike}, not distinguished there)" if alike else ""
    return f"{what} {where}; {plural(int(region.rows.sum()), 'touch')}"


def structure_words(found: Structure) -> str:
    """A pattern for a table: `varies with X and Y, along Z`."""
    names = listed([noun(name) for name in found.variables])
    along = "the normal" if found.direction == "normal" else found.direction
    match found.shape:
        case Shape.SMOOTH if found.variables[0] in _GROUPS:
            return f"differs from {names} to {names}, along {along}"
        case Shape.SMOOTH:
            return f"varies with {names}, along {along}"
        case Shape.DRIVER:
            return f"drifts slowly as {found.law} would after a temperature that was not recorded"
        case Shape.WAVE:
            return f"wave in time of period {span(found.period)}, along {along}"
        case Shape.NEIGHBOURS:
            return f"touches that are neighbours in {names} agree"
        case Shape.CROWD:
            return f"gross errors are concentrated in {names}"


def structure_clause(found: Structure) -> str:
    """The same as a clause after a colon."""
    it = "it " if found.shape in (Shape.SMOOTH, Shape.DRIVER) else ""
    return it + structure_words(found)


def scanned_sentence(found: Sequence[Detectable]) -> str:
    """Searched ranges of periods, time constants and the like; "" where there is none."""
    ranges: dict[tuple[str, str], tuple[float, float]] = {}
    scans = (s for d in found if d.size is not None for s in d.scanned)
    for scan in (s for s in scans if s.unit or s.quantity == "harmonic"):
        key = (_WORDS.get(scan.quantity, scan.quantity), scan.unit)
        low, high = ranges.get(key, (scan.low, scan.high))
        ranges[key] = (min(low, scan.low), max(high, scan.high))
    each = [
        f"{name}s of {digits(low)} to {digits(high)}{f' {unit_words(unit)}' if unit else ''}"
        for (name, unit), (low, high) in sorted(ranges.items())
    ]
    return f"Searched: {listed(each)}; nothing is known outside these ranges." if each else ""


def far_setups(run: Run) -> list[str]:
    """Sentences on set-ups in which the standard was clamped otherwise than the file states."""
    return [_far_setup(moved) for moved in run.moved if moved.is_far]


def _far_setup(moved: Moved) -> str:
    """`Set-up a stands a quarter turn about Z of the table (+89.99°) from where the file ...`."""
    angle, said = moved.turn / DEG, []
    if moved.turn > FAR_TURN:
        axis = moved.turned / moved.turn
        i = int(np.argmax(np.abs(axis)))
        about = f"({', '.join(f'{a:.2f}' for a in axis)})"
        if abs(axis[i]) > ALONG_AXIS:
            about, angle = "XYZ"[i], float(np.copysign(angle, axis[i]))
        by = f"{angle:+.2f}°"
        name = next((w for w, whole in TURNS.items() if abs(abs(angle) - whole) < NEARLY_WHOLE), "")
        turn = f"{name} about {about} of the table ({by})"
        said.append(turn if name else f"turned by {by} about {about} of the table")
    if float(np.linalg.norm(moved.origin)) > FAR_SHIFT:
        parts = [f"{a} {round(x, 1) + 0.0:+.1f}" for a, x in zip("XYZ", moved.origin, strict=True)]
        said.append(f"{', '.join(parts)} mm")
    return (
        f"Set-up {moved.name} stands {listed(said)} from where the file states it: check origin_mm "
        "and rotation_deg of the set-up, and that the standard was clamped as planned; the place "
        "that the touches show is used."
    )


def comparison_sentence(found: Comparison) -> str:
    """Error of a model on a run, with its worst touch and the pattern of its residual.

    First stand set-ups that are not where the file states them.
    """
    return " ".join([*far_setups(found.run), _compared(found)])


def _compared(found: Comparison) -> str:
    """The same of the model alone."""
    worst, left = found.worst, microns(found.rms)
    after = "after the prediction" if found.is_prediction else "after the fit"
    more = "" if found.rms <= found.rms_measured else ", more than before"
    text = (
        f"Measured {microns(found.rms_measured)} rms; {left} rms remain {after}{more}. The stated "
        f"noise is {microns(stated_noise(found.run))}, chi-square per degree of freedom "
        f"{digits(found.chi2_ratio)}. The worst touch (line {found.run.line[worst]}) deviates by "
        f"{microns(float(found.residual[worst]))}, "
        f"{digits(abs(float(found.normalised[worst])), 2)} times its uncertainty."
    )
    if found.structure:
        return f"{text} The residual is not noise: {structure_clause(found.structure[0])}."
    if found.where:
        return f"{text} The residual is not noise: {region_sentence(found.where[0])}."
    if found.is_larger:
        return (
            f"{text} The residual has no pattern, but is larger than the stated uncertainty "
            f"(probability by chance {p_value(found.chance)})."
        )
    return f"{text} The residual looks like noise."


def figures(fit: Fit) -> tuple[str, str, str]:
    """Fitted and held-out error, µm, and chi-square per degree of freedom, as in all tables."""
    return f"{fit.rms / UM:.3f}", f"{fit.test_rms / UM:.3f}", digits(fit.noise.chi2_ratio)


def learnt_lines(fit: Fit, numbers: Mapping[str, Sequence[Reported]]) -> list[str]:
    """Figures and effects, numbers by name, of the fit from which a model was estimated."""
    rms, held_out, chi2 = figures(fit)
    first = (
        f"The model was estimated from these rows: fitted {rms} µm, held out {held_out} µm, "
        f"chi-square per degree of freedom {chi2}."
    )
    each = {
        name: ", ".join(" ".join(v) for v in number_words(r, name)) for name, r in numbers.items()
    }
    chain = fit.run.touches.chain
    return [first, *(f"{words_of_name(name, chain)}: {w}" for name, w in each.items() if w)]


def _memory(fit: Fit) -> str:
    """Correlation of the noise of a fit; empty for white noise."""
    memory = fit.memory
    if memory is None:
        return ""
    return memory_words(memory.correlation, memory.step, memory.by_place)
