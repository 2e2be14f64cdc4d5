"""What the pages on measurements say in words: verdicts with numbers, sizes with uncertainties."""

import math

from diagnosis.describe import Reported
from diagnosis.fit import Fit
from diagnosis.residuals import Comparison
from diagnosis.verdict import Diagnosis, Step, Verdict
from matstd.page import digits
from twin.run import Run
from twin.units import UM

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


def with_uncertainty(value: float, u: float | None, unit: str = "") -> str:
    """A number to two digits of its uncertainty.

    Example:
        >>> with_uncertainty(11.137, 0.538, "µm")
        '11.14 ± 0.54 µm'
    """
    tail = f" {unit}" if unit else ""
    if u is None or not u > 0.0 or not math.isfinite(u):
        return f"{digits(value)}{tail}"
    places = max(0, 1 - math.floor(math.log10(u)))
    return f"{value:.{places}f} ± {u:.{places}f}{tail}"


def named_value(reported: Reported) -> tuple[str, str]:
    """Name and value of a number of an effect as a reader sees them: `time constant`, `42 ± 3 min`.

    Example:
        >>> named_value(Reported("tau_min", 42.07, 3.32, 60.0))
        ('time constant', '42.1 ± 3.3 min')
    """
    name, unit = next(
        ((reported.name[: -len(end)], unit) for end, unit in _UNITS if reported.name.endswith(end)),
        (reported.name, ""),
    )
    return _WORDS.get(name, name).replace("_", " "), with_uncertainty(
        reported.value, reported.u, unit
    )


def sizes(step: Step, most: int) -> str:
    """The leading numbers of an added effect in one clause."""
    return ", ".join(" ".join(named_value(r)) for r in step.reported[:most])


def microns(value: float) -> str:
    """A length in µm to two decimals, or to three digits where that would say nothing."""
    um = value / UM
    return f"{um:.2f} µm" if abs(um) >= 0.095 else f"{digits(um, 2)} µm"


def stated_noise(run: Run) -> float:
    """Stated standard uncertainty of a touch, root mean square, mm."""
    return float((run.u**2).mean() ** 0.5)


def _clause(words: str) -> str:
    """Words on what a residual does, as a clause that stands after a colon."""
    return f"it {words}" if words.startswith("varies") else words


def noise_words(fit: Fit) -> str:
    """The noise as found, and as stated where that is another."""
    stated = stated_noise(fit.run)
    found = stated * fit.noise.factor
    if fit.noise.is_wrongly_stated:
        return f"{microns(found)} (stated: {microns(stated)})"
    return microns(stated)


def excess(fit: Fit) -> float:
    """Root mean square of what is left beyond the stated noise, mm."""
    stated = stated_noise(fit.run)
    return stated * math.sqrt(max(fit.noise.factor**2 - 1.0, 0.0))


def _fall(diagnosis: Diagnosis) -> str:
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
    return f"{name} ({sizes(step, most)}{alike})"


def verdict_sentence(diagnosis: Diagnosis) -> str:
    """The verdict in one plain sentence, with numbers and standard uncertainties."""
    most = 3 if len(diagnosis.steps) == 2 else 2 if len(diagnosis.steps) == 3 else 1
    added = [_added(s, most) for s in diagnosis.steps[1:]]
    if diagnosis.verdict is Verdict.MISSING:
        what, them = ("one effect", "it") if len(added) == 1 else (f"{len(added)} effects", "them")
        return (
            f"The model lacks {what}: {'; '.join(added)}. With {them} {_fall(diagnosis)}; the "
            f"noise is {noise_words(diagnosis.fit)}."
        )
    if diagnosis.verdict is Verdict.UNEXPLAINED:
        words = "; ".join(dict.fromkeys(_clause(d.words) for d in diagnosis.depends_on[:2]))
        named = f" Named were {'; '.join(added)}: {_fall(diagnosis)}." if added else ""
        return (
            f"Something is left that no effect of the library accounts for: "
            f"{microns(excess(diagnosis.fit))} rms beyond the stated noise of "
            f"{microns(stated_noise(diagnosis.run))}. It is no noise: "
            f"{words or 'it varies with nothing that was recorded'}.{named}"
        )
    named = f" Added by name were {'; '.join(added)}: {_fall(diagnosis)}." if added else ""
    return (
        f"Nothing is missing that this run could have shown: the error of held-out touches is "
        f"{microns(diagnosis.fit.test_rms)}, and the noise is {noise_words(diagnosis.fit)}.{named}"
    )


def comparison_words(found: Comparison) -> str:
    """What a model leaves of a run, in one plain sentence with numbers."""
    made = "predicts" if found.is_prediction else "fitted to the run explains"
    worst = found.worst
    text = (
        f"Of {microns(found.rms_measured)} rms that were measured the model {made} all but "
        f"{microns(found.rms)}; the noise is stated as {microns(stated_noise(found.run))}, "
        f"chi-square per degree of freedom is {digits(found.chi2_ratio)}, and the worst touch "
        f"(line {found.run.line[worst]}) is off by {microns(float(found.residual[worst]))}."
    )
    if not found.structure:
        return f"{text} What is left looks like noise."
    return f"{text} What is left is not noise: {_clause(found.structure[0].words)}."
