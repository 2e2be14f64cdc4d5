"""What a diagnosis leaves open, in sentences: the nearest effect, noise that nothing shows."""

from matstd.diagnosis.answer import Diagnosis
from matstd.report.numbers import digits
from matstd.twin.record import Run
from matstd.twin.units import UM
from matstd.twin.words import listed


def microns(value: float) -> str:
    """A length in µm to two decimals, or to two digits where that would say nothing."""
    um = value / UM
    return f"{um:.2f} µm" if abs(um) >= 0.095 else f"{digits(um, 2)} µm"


def stated_noise(run: Run) -> float:
    """Stated standard uncertainty of a touch, root mean square, mm."""
    return float((run.u**2).mean() ** 0.5)


def nearest_clause(diagnosis: Diagnosis) -> str:
    """The effect nearest to what is left, with what it is worth; empty where there is none."""
    if not diagnosis.nearest:
        return ""
    best, *others = diagnosis.nearest
    before, after = microns(diagnosis.fit.test_rms), microns(best.test_rms)
    also = f"; next: {listed([o.effect for o in others])}" if others else ""
    return (
        f" The nearest effect is {best.effect} (p = {best.p_value:.0e}): with it the error of "
        f'held-out touches goes from {before} to {after}; add it with --add "{best.effect}"{also}.'
    )


def undecided_sentence(diagnosis: Diagnosis) -> str:
    """That the noise alone would explain the run, if it were so large."""
    noise = diagnosis.fit.noise
    lines = [str(line) for line in sorted(diagnosis.run.line[diagnosis.repeat])]
    shown = (
        "no touch was repeated"
        if noise.replicates is None
        else f"{noise.replicates_dof} repeated touches show {digits(noise.replicates, 2)} times it"
    )
    size = noise.factor * stated_noise(diagnosis.run)
    return (
        f"Whether an effect is missing cannot be decided: the noise would have to be "
        f"{microns(size)}, {digits(noise.factor, 2)} times the stated one, and {shown}. Repeat the "
        f"touches of lines {listed(lines)} three times each, all else unchanged; a residual that "
        f"comes again is no noise."
    )
