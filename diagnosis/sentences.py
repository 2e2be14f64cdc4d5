"""What is said of a run: verdicts with numbers, sizes with uncertainties, what is left."""

import math
from collections.abc import Sequence

from diagnosis.describe import Reported
from diagnosis.fit import Fit
from diagnosis.remarks import memory_words
from diagnosis.residuals import Comparison
from diagnosis.verdict import Diagnosis, Step, Verdict
from twin.effect import Tunable
from twin.run import Run
from twin.units import UM
from twin.words import digits, listed, span, with_uncertainty

_UNITS = (
    ("_um_per_m_K", "µm/(m K)"),
    ("_urad_per_K", "µrad/K"),
    ("_um_per_K", "µm/K"),
    ("_um_per_h", "µm/h"),
    ("_urad_per_h", "µrad/h"),
    ("_um_per_N", "µm/N"),
    ("_urad", "µrad"),
    ("_um", "µm"),
    ("_min", "min"),
    ("_mm", "mm"),
    ("_deg", "°"),
    ("_s", "s"),
)
"""Endings of the names of numbers in files, the longest first, with the unit that a reader sees."""

_WORDS = {"tau": "time constant"}

ALL_TOLD = 7
"""Numbers of an effect that are told one by one; of more only the size is."""


_NUMBERS = {1: 3, 2: 2, 3: 1}
"""Numbers of an effect in the verdict by the number of effects; of more effects only the names."""


def named_value(reported: Reported) -> tuple[str, str]:
    """Name and value of a number of an effect as a reader sees them: `time constant`, `42 ± 3 min`.

    Example:
        >>> named_value(Reported("tau_min", 42.07, 3.32, 60.0))
        ('time constant', '42.1 ± 3.3 min')
        >>> named_value(Reported("instant_s", 7083.0, None, 1.0))
        ('instant', '1.97 h')
        >>> named_value(Reported("tau_min", 2.0, None, 60.0, bound=-1))
        ('time constant', 'at most 2.00 min')
    """
    name, unit = next(
        ((reported.name[: -len(end)], unit) for end, unit in _UNITS if reported.name.endswith(end)),
        (reported.name, ""),
    )
    words = _WORDS.get(name, name).replace("_", " ")
    if reported.bound:
        side = "at most" if reported.bound < 0 else "at least"
        return words, f"{side} {digits(reported.value, 3)} {unit}".rstrip()
    if unit == "s" and reported.u is None:
        return words, span(reported.value)
    return words, with_uncertainty(reported.value, reported.u, unit)


def values(step: Step) -> list[tuple[str, str]]:
    """Numbers of an added effect as a reader sees them, its size first.

    Of an effect with many coefficients only what sums them up and its inner parameters are told.
    """
    told = sorted(step.reported, key=lambda r: _rank(step, r))
    if len(told) > ALL_TOLD:
        told = [r for r in told if _rank(step, r) in (0, 2)] or told[:ALL_TOLD]
    return [named_value(r) for r in told]


def _rank(step: Step, reported: Reported) -> int:
    """Place of a number of an effect: its size, its inner parameters, what the size is made of.

    Where nothing sums them up the linear parameters are the size.
    """
    inner = step.effect.tuning if isinstance(step.effect, Tunable) else {}
    if reported.name.startswith("amplitude"):
        return 0
    if any(reported.name.partition("_")[0] == name for name in inner):
        return 2
    return 3 if any(r.name.startswith("amplitude") for r in step.reported) else 1


def sizes(step: Step, most: int) -> str:
    """The leading numbers of an added effect in one clause, its size first."""
    return ", ".join(" ".join(value) for value in values(step)[:most])


def microns(value: float) -> str:
    """A length in µm to two decimals, or to two digits where that would say nothing."""
    um = value / UM
    return f"{um:.2f} µm" if abs(um) >= 0.095 else f"{digits(um, 2)} µm"


def stated_noise(run: Run) -> float:
    """Stated standard uncertainty of a touch, root mean square, mm."""
    return float((run.u**2).mean() ** 0.5)


def noise_words(fit: Fit) -> str:
    """The noise as found, and as stated where that is another."""
    stated = stated_noise(fit.run)
    found = stated * fit.noise.factor
    remembers = fit.memory is not None and fit.memory.is_filtered
    after = f" and remembers ({memory_words(fit)})" if remembers else ""
    if fit.noise.is_wrongly_stated:
        return f"{microns(found)} (stated: {microns(stated)}){after}"
    return f"{microns(stated)}{after}"


def excess(fit: Fit) -> float:
    """Root mean square of what is left beyond the stated noise, mm."""
    stated = stated_noise(fit.run)
    return stated * math.sqrt(max(fit.noise.factor**2 - 1.0, 0.0))


def clause(words: str) -> str:
    """Words on what a residual does, as a clause that stands after a colon."""
    return f"it {words}" if words.startswith("varies") else words


def _fall(diagnosis: Diagnosis) -> str:
    if diagnosis.choice is not None and not diagnosis.fit.test_rows.any():
        first, best = diagnosis.choice.ways[0], diagnosis.choice.best
        return (
            f"the plain error of blocks left out, the choice made anew without each, falls from "
            f"{microns(first.error)} to {microns(best.error)}"
        )
    return (
        f"the error of held-out touches falls from {microns(diagnosis.start.test_rms)} to "
        f"{microns(diagnosis.fit.test_rms)}"
    )


def _added(step: Step, most: int) -> str:
    """An effect with its leading numbers, and whether another name would do as well."""
    rivals = len(step.confusion.rivals) if step.confusion else 0
    name = step.effect.name if step.effect is not None else ""
    alike = f", or one of {rivals} effects that look the same" if rivals else ""
    if step.confusion is not None and rivals == 1:
        alike = f", or {step.confusion.rivals[0].effect.name}"
    told = f"{sizes(step, most)}{alike}".removeprefix(", ")
    return f"{name} ({told})" if told else name


def _them(steps: Sequence[Step]) -> str:
    return "it" if len(steps) == 1 else "them"


def verdict_sentence(diagnosis: Diagnosis) -> str:
    """The verdict in one plain sentence, with numbers and standard uncertainties."""
    most = _NUMBERS.get(len(diagnosis.steps) - 1, 0)
    steps = diagnosis.steps[1:]
    named = [_added(s, most) for s in steps if s.is_named]
    found = [_added(s, most) for s in steps if not s.is_named]
    also = f" Added by name: {'; '.join(named)}." if named else ""
    if diagnosis.verdict is Verdict.MISSING:
        what = "one effect" if len(found) == 1 else f"{len(found)} effects"
        return (
            f"The model lacks {what}: {'; '.join(found)}.{also} With {_them(steps)} "
            f"{_fall(diagnosis)}; the noise is {noise_words(diagnosis.fit)}."
        )
    if diagnosis.verdict is Verdict.UNEXPLAINED:
        words = "; ".join(dict.fromkeys(clause(d.words) for d in diagnosis.depends_on[:2]))
        was = "was" if len(steps) == 1 else "were"
        what = f" Put in {was} {'; '.join([*named, *found])}: {_fall(diagnosis)}." if steps else ""
        return (
            f"Something is left that no effect of the library accounts for: "
            f"{microns(excess(diagnosis.fit))} rms beyond the stated noise of "
            f"{microns(stated_noise(diagnosis.run))}. It is no noise: "
            f"{words or 'it varies with nothing that was recorded'}.{what}"
        )
    fall = f" With {_them(steps)} {_fall(diagnosis)}." if named else ""
    return (
        f"Nothing{' more' if named else ''} is missing that this run could have shown: the error "
        f"of held-out touches is {microns(diagnosis.fit.test_rms)}, and the noise is "
        f"{noise_words(diagnosis.fit)}.{also}{fall}"
    )


def comparison_sentence(found: Comparison) -> str:
    """What a model leaves of a run, in plain words with numbers."""
    made = "predicts" if found.is_prediction else "fitted to the run explains"
    worst = found.worst
    text = (
        f"Of {microns(found.rms_measured)} rms that were measured the model {made} all but "
        f"{microns(found.rms)}; the noise is stated as {microns(stated_noise(found.run))}, "
        f"chi-square per degree of freedom is {digits(found.chi2_ratio)}, and the worst touch "
        f"(line {found.run.line[worst]}) is off by {microns(float(found.residual[worst]))}, "
        f"{digits(abs(float(found.normalised[worst])), 2)} times its uncertainty."
    )
    if found.rms > found.rms_measured:
        text = text.replace(
            f"all but {microns(found.rms)}", f"nothing: {microns(found.rms)} are left"
        )
    if not found.structure:
        return f"{text} What is left looks like noise."
    return f"{text} What is left is not noise: {clause(found.structure[0].words)}."


BROKEN = 1.1
"""Error over what was promised from which a promise is called broken; the figures themselves
scatter by a few per cent."""


def promise_sentence(found: Comparison, promised: float) -> str:
    """The error of a prediction beside the one that its model promised (mm), in plain words."""
    word = "worse than" if found.rms > BROKEN * promised else "as good as"
    return (
        f"That is {word} was promised: {microns(found.rms)} beside {microns(promised)}, the error "
        "of rows that the model had not seen when it was made."
    )


def rivals_words(step: Step, most: int = 2) -> str:
    """What an effect cannot be told from, in a cell of a table."""
    names = [r.effect.name for r in step.confusion.rivals] if step.confusion else []
    more = f" and {len(names) - most} more" if len(names) > most else ""
    return (", ".join(names[:most]) if more else listed(names) if names else "") + more
