"""Laws in words: formula, numbers, what carries them, how they compare with their rivals."""

import math
import re
from collections.abc import Sequence

import numpy as np

from matstd.diagnosis.laws import (
    Estimate,
    Learning,
    LearntLaw,
    Refusal,
    amplitudes,
    partial_residual,
    places,
)
from matstd.report.laws.looks import looks_like
from matstd.report.laws.run_words import run_sentence
from matstd.report.numbers import microns, odds_words, with_uncertainty
from matstd.twin.laws import Carrier, Driver, Factor, Law, drivers
from matstd.twin.units import DEG, HOUR, MINUTE, UM, URAD
from matstd.twin.words import listed

_VARIABLES = {
    "time": "time",
    "since-setup": "time since set-up",
    "since-pose": "time since the pose was reached",
    "since-switch": "time since the speed changed",
    "rpm": "spindle speed",
    "load": "load",
    "azimuth": "azimuth of the contact",
    "latitude": "latitude of the contact",
}
_CARRIERS = {
    "bias": "the reading of the probe along the normal",
    "shift": "a displacement of the standard",
    "tilt": "a tilt of the standard",
    "growth": "a growth of the standard",
}
_SHAPES = {
    "sign": "a reversal",
    "lin": "a straight line",
    "lin-from": "a straight line with a constant",
    "quad": "a parabola",
    "quad-about": "a parabola",
    "cubic": "a third power",
    "power": "a power",
    "bump": "a bump",
    "bump-before": "a bump that ends at its top",
    "bump-after": "a bump that begins at its top",
    "pulse": "a pulse that dies away",
    "step": "a step",
    "window": "a window",
    "ramp": "a ramp",
    "plateau": "a plateau with flanks",
    "kink": "a kink",
    "kink-before": "a kink",
    "saturation": "a saturation",
    "dead-band": "a dead band",
    "exp": "an exponential decay",
    "settling": "an exponential settling",
    "two-exp": "two exponentials",
    "log": "a logarithm",
    "sine": "a sine",
    "harmonic": "waves a turn",
    "square": "a square wave",
    "saw": "a saw-tooth",
    "half-wave": "a half-wave",
    "hysteresis": "a hysteresis loop",
    "play": "a play that follows",
    "play-quad": "the square of a play that follows",
    "beyond": "what is not known beyond the probed range",
    "course": "what is not known of a driver that was not recorded",
    "curve": "a smooth curve without a formula",
    "surface": "a smooth surface without a formula",
}
FEW_TOUCHES = 60  # below it a run leaves few degrees of freedom beside geometry and set-ups
_EDGES = ("x0", "x1", "x2")  # parameters of shapes that are values of the variable


def variable_words(driver: Driver) -> str:
    """A variable: `Y`, `temperature of spindle`, `direction of X`."""
    name = driver.name
    if name.startswith("last-"):
        return f"direction of {name.removeprefix('last-')}"
    if name.startswith("trend-T-"):
        return f"rise of the temperature {name.removeprefix('trend-T-')}"
    if name.startswith("T-"):
        return f"temperature {name.removeprefix('T-')}"
    return _VARIABLES.get(name, name.removeprefix("V-"))


def carrier_words(carrier: Carrier) -> str:
    """A carrier: `EZX`, `a displacement of the standard`."""
    return _CARRIERS.get(carrier.name, carrier.name)


def formula_words(law: Law) -> str:
    """`EZX = a exp(-((Y - x0)/w)^2)`, with the numbers that no run determines."""
    if law.is_surface:
        over = listed([driver.name for driver in law.drivers])
        return f"{law.carrier.name} = {law.factors[0].shape.formula} {over}"
    several = any(len(f.shape.coefficients) > 1 for f in law.factors)
    parts = []
    for factor, own in law.parts:
        text, _, u = factor.shape.formula.partition(", u = ")
        text = re.sub(r"\bu\b", f"({u})", text)
        words = dict(zip(factor.shape.places, law.place_names[own], strict=True))
        for place, value in zip(factor.shape.places, law.places[own], strict=True):
            if place == "zero" and value == 0.0:
                text = text.replace("(x - zero)", "x").replace("x - zero", "x")
            if place in ("zero", "unit", "k"):
                words[place] = _fixed_words(value, "" if place == "k" else _unit(factor.driver))
        words["x"] = factor.driver.name
        text = "".join(words.get(part, part) for part in re.split(r"\b", text))
        text = text.replace("- -", "+ ")
        if len(law.factors) > 1:
            text = f"[{text}]"
        elif not several and re.search(", | - ", _outside_brackets(text)):
            text = f"({text})"
        parts.append(text)
    return f"{law.carrier.name} = {'' if several else 'a '}{' '.join(parts)}"


def _outside_brackets(text: str) -> str:
    inner = re.sub(r"\([^()]*\)", "", text)
    return text if inner == text else _outside_brackets(inner)


def _unit(driver: Driver) -> str:
    """Unit of a variable; of a column of the user's own that of its name: `bar`, `l/min`."""
    own = re.search(r"^V-.*?_((?:(?:[kcm]?[glm]|m3)_(?=(?:s|min|h)$))?[^_]+)$", driver.name)
    return own[1].replace("_", "/") if own else driver.unit


def _fixed_words(value: float, unit: str) -> str:
    """`20 °C`, `300 mm`, `h`: a number of a formula that follows from the machine."""
    if unit == "1/min":
        return f"({value:g}/min)"
    unit = unit.replace("degC", "°C")
    if unit == "s" and value == HOUR:
        return "h"
    words = unit if unit and value == 1.0 else f"{value:g} {unit}".strip()
    return f"({words})" if "/" in words else words


_POWERS = {"quad": "²", "quad-about": "²", "cubic": "³", "power": "^p", "play-quad": "²"}
"""Power of the variable that the amplitude of a shape is per unit of; of others the first."""


def amplitude_words(law: Law, one: Estimate) -> str:
    """`-10.3 ± 0.3 µm`; of a slope per what, `-4.01 ± 0.04 µm per K`, `3.1 ± 0.2 µm per 300 mm`."""
    scale, unit = {"mm": (UM, "µm"), "rad": (URAD, "µrad"), "1": (1.0, "")}.get(
        one.unit, (1.0, one.unit)
    )
    words = with_uncertainty(one.value / scale, None if one.u is None else one.u / scale, unit)
    words += "".join(f" per {_unit_of(law, f, own)}" for f, own in law.parts if _is_per(f, one))
    return f"{one.name} {words}" if one.name != "amplitude" else words


def _is_per(factor: Factor, one: Estimate) -> bool:
    """Whether an amplitude is per unit of the variable of a factor."""
    is_constant = len(factor.shape.coefficients) > 1 and "slope" not in one.name
    return "unit" in factor.shape.places and not is_constant


def _unit_of(law: Law, factor: Factor, own: slice) -> str:
    """What a slope over a variable is per: `K`, `(300 mm)²`, `rad`, `bar`."""
    value = law.places[own][factor.shape.places.index("unit")]
    words = _fixed_words(value, _unit(factor.driver)).replace("°C", "K")
    power = _POWERS.get(factor.shape.word, "")
    return f"({words}){power}" if power and " " in words else f"{words}{power}"


def place_words(one: Estimate) -> str:
    """`x0 = 7.0 ± 0.4 mm`."""
    scale, unit = {"mm": (1.0, "mm"), "rad": (DEG, "°"), "degC": (1.0, "°C"), "1": (1.0, "")}.get(
        one.unit, (1.0, one.unit)
    )
    if one.unit == "s":
        scale, unit = (MINUTE, "min") if abs(one.value) > 5 * MINUTE else (1.0, "s")
    words = with_uncertainty(one.value / scale, None if one.u is None else one.u / scale, unit)
    return f"{one.name} {words}"


def law_sentence(learning: Learning, one: LearntLaw) -> str:
    """What was learnt: where it moves the tool, what carries it, its shape with all numbers."""
    law, numbers, size = one.law, places(learning, one.law), _size(learning, one.law)
    is_plain = len(law.factors) == 1 and not law.is_curve_alone
    what = _shapes_words(law, numbers, size if is_plain else "")
    what += "" if is_plain else f", {size}"
    return f"{_carried_words(law.carrier, one.alike)}: {what}".replace("  ", " ") + "."


def short_words(law: Law) -> str:
    """A law without its numbers: `EBY as a parabola over the temperature spindle`."""
    return f"{carrier_words(law.carrier)} as {_shapes_words(law)}"


def _shapes_words(law: Law, numbers: Sequence[Estimate] = (), size: str = "") -> str:
    """Shapes of a law in words; a surface is one over both variables."""
    if law.is_surface:
        one, other = (variable_words(driver) for driver in law.drivers)
        return f"{_SHAPES['surface']} over {one} and {other}"
    return " times ".join(
        _shape_words(factor, law.places[own], numbers[own], size) for factor, own in law.parts
    )


def _carried_words(carrier: Carrier, alike: Sequence[Carrier]) -> str:
    """`along Z, carried by Y (EZY)`."""
    same = listed([c.name for c in alike], "or")
    notes = [f"this run cannot distinguish it from {same}"] if alike else []
    if carrier.symbol is None:
        words = carrier_words(carrier)
    else:
        words = f"{carrier.symbol.motion}, carried by {carrier.symbol.link}"
        notes.insert(0, carrier.name)
    return f"{words} ({'; '.join(notes)})" if notes else words


def _shape_words(
    factor: Factor, values: Sequence[float], numbers: Sequence[Estimate], size: str = ""
) -> str:
    """`a bump of -10.3 ± 0.3 µm over Y at 7.7 ± 0.6 mm (w 48.0 ± 1.4 mm)`.

    Args:
        values: Of the parameters of the shape.
        numbers: The same with their uncertainties, to be stated; empty for none of them.
    """
    free = [numbers[i] for i in factor.shape.free] if numbers else []
    plain = [p._replace(name=p.name.removesuffix("-2")) for p in free]
    edges = [place_words(p).split(maxsplit=1)[1] for p in plain if p.name in _EDGES]
    others = [place_words(p) for p in plain if p.name not in _EDGES]
    others += ["without uncertainty"] if any(p.u is None for p in plain) else []
    words = _SHAPES[factor.shape.word]
    if factor.shape.word == "harmonic":
        words = f"{values[0]:.0f} {words}" if values[0] > 1 else "one wave a turn"
    words += f" of {size}" if size else ""
    words += f" over {variable_words(factor.driver)}"
    if edges:
        words += f" from {edges[0]} to {edges[1]}" if len(edges) > 1 else f" at {edges[0]}"
    return f"{words} ({', '.join(others)})" if others else words


def size_words(learning: Learning, law: Law) -> str:
    """Size of a law with the parameters of its shapes, each with its uncertainty."""
    numbers = places(learning, law)
    return ", ".join([_size(learning, law), *(place_words(numbers[i]) for i in law.free)])


def _size(learning: Learning, law: Law) -> str:
    found = amplitudes(learning, law)
    if law.is_curve_alone:
        own = partial_residual(learning, law)[1]
        return f"{microns(float((own**2).mean() ** 0.5))} rms at the touches"
    shapes = [f.shape.word for f in law.factors]
    if "sign" in shapes or (len(found) == 1 and shapes.count("saturation") == 1):
        # from -a to a: a ramp, and a reversal of the library, are said with what lies between
        whole = [
            a._replace(value=2.0 * a.value, u=None if a.u is None else 2.0 * a.u) for a in found
        ]
        return f"{_total_words(law, whole)} from end to end"
    return _total_words(law, found)


def _total_words(law: Law, found: Sequence[Estimate]) -> str:
    """Amplitudes in words; several of one unit by the root of the sum of their squares."""
    if len(found) == 1 or any("slope" in a.name for a in found):  # no two of one unit to sum
        return ", ".join(amplitude_words(law, a) for a in found)
    total = math.sqrt(sum(a.value**2 for a in found))
    u = math.sqrt(sum((a.value * (a.u or 0.0)) ** 2 for a in found)) / max(total, 1e-300)
    return amplitude_words(law, Estimate("amplitude", total, u, found[0].unit))


def rival_sentence(one: LearntLaw) -> str:
    """The nearest law of another carrier or other variables, with its odds; empty for none."""
    rival = one.second_choice
    if rival is None:
        return ""
    return f"Second choice: {short_words(rival.law)} (odds {odds_words(rival.log_odds)})."


def library_sentence(one: LearntLaw) -> str:
    """How the law compares with the best effect of the library; empty where none is near."""
    if one.library is None:
        return ""
    name, odds = one.library.effect.name, one.library_odds
    if one.is_of_library and not one.is_behind_library:
        return f"The library explains it as well: {name} (odds {odds_words(odds)} for the law)."
    if odds < 0.0:
        better = f"The library explains it better: {name} (odds {odds_words(-odds)})."
        return f'{better} Take that effect: matstd diagnose --add "{name}".'
    return f"The nearest effect of the library is {name} (odds {odds_words(odds)} for the law)."


def instead_sentence(learning: Learning) -> str:
    """Names that are withdrawn, since laws explain the run better; empty for none."""
    if not learning.instead_of:
        return ""
    names = listed([effect.name for effect in learning.instead_of])
    many = len(learning.instead_of) > 1
    laws = "the laws explain" if len(learning.laws) > 1 else "the law explains"
    return (
        f"Withdrawn: {names}, which imitate{'' if many else 's'} a part of it; {laws} the run "
        f"better than {'these names' if many else 'this name'}, also with a law beside "
        f"{'them' if many else 'it'}: odds {odds_words(learning.instead_odds)}."
    )


def law_notes(learning: Learning) -> list[str]:
    """What is to be known of the laws beside their numbers: the library, what they look like."""
    out = []
    for one in learning.laws:
        out += [library_sentence(one), rivals_sentence(one), looks_like(one.law)]
        out.append("" if one.travels else run_sentence(one))
    return [line for line in (*out, *limits_sentences(learning)) if line]


def limits_sentences(learning: Learning) -> list[str]:
    """What a run cannot show: of few touches, of one pose, of variables with two values."""
    fit, out = learning.before, []
    touches, count = fit.run.touches, int(fit.used.sum())
    if count < FEW_TOUCHES and learning.refusal is not Refusal.FEW:
        out.append(f"From {count} touches only a law far above the noise can be learnt.")
    stays = np.column_stack([touches.setup, touches.q[:, touches.chain.rotary_columns]])
    if touches.chain.rotary_axes and len(np.unique(stays.round(6), axis=0)) == 1:
        out.append(
            "All touches are in one pose: carriers that differ only in others are not "
            "distinguished, and a law over a rotary axis is not seen."
        )
    two = [
        variable_words(driver)
        for driver in drivers(touches)
        if driver.nature != "sign" and len(np.unique(driver.values(touches))) == 2
    ]
    if two:
        each = "has two values" if len(two) == 1 else "have two values each"
        out.append(f"Of {listed(two)}, which {each}, only a step can be learnt.")
    return out


def learnt_words(learning: Learning) -> str:
    """What was learnt of a remainder, as a clause."""
    if not learning.laws:
        return "no law of any carrier and variable explains it"
    word = "learnt law" if len(learning.laws) == 1 else "learnt laws"
    return f"{word}: {'; '.join(short_words(one.law) for one in learning.laws)}"


def rivals_sentence(one: LearntLaw) -> str:
    """How the law compares with what has no carrier or no variable; empty for a law of time."""
    if any(f.driver.nature == "time" for f in one.law.factors):
        return ""
    odds = odds_words(one.score - max(one.drift, 0.0))
    return f"Odds against a driver that was not recorded but is smooth in time: {odds}."


def no_law_sentence(learning: Learning) -> str:
    """What is said where no law was learnt, and why the best one was not kept."""
    noise = microns(float(learning.before.rms))
    touches = int(learning.before.used.sum())
    left = f"what the model leaves of {touches} touches ({noise} rms)"
    best = learning.refused
    if learning.refusal is Refusal.FEW:
        return f"No law was looked for: {touches} touches distinguish none from another."
    if best is None or learning.refusal in (None, Refusal.CHANCE):
        return f"No law: {left} follows no carrier and variable beyond chance."
    name = short_words(best.law)
    if learning.refusal is Refusal.LIBRARY:
        return f"No law beside the library. {library_sentence(best)}"
    if learning.refusal is Refusal.MEMORY:
        return (
            f"No law: noise that remembers from touch to touch explains {left} better than {name}."
        )
    return f"No law: touches left out are not predicted better with the best one, {name}."


def held_out_sentence(learning: Learning) -> str:
    """The error of touches left out, without and with the laws."""
    first = learning.held_out[0]
    return (
        f"Touches of poses left out are predicted with {microns(first.after)} rms instead of "
        f"{microns(first.before)}."
    )
