"""Results of a calibration and the material of a standard, for pages and console."""

from collections.abc import Sequence

from matstd.artefact.body import Material, Verdict
from matstd.artefact.certify import MAX_SPACING, CalibrationFit, CommonCause
from matstd.artefact.layout import DEFAULT_MODULUS
from matstd.report.numbers import digits, um
from matstd.twin.units import GPA, T_REF, UM, URAD
from matstd.twin.words import few, listed

PPM = 1e-6
_SIGNED = ("diameter", "scale")
_NAMED = 3  # characteristics that a refusal names
_WARM = 15.0  # K about 20 degC, within which pieces are measured


def calibration_lines(found: CalibrationFit) -> list[str]:
    """The largest deviation, every feature with its uncertainty, assumptions."""
    known = found.known
    worst = max(found.moved, key=lambda name: found.moved[name])
    lines = [
        f"{len(known.features)} features of '{found.standard.name}' from {known.source}; "
        f"{worst} deviates most from the design, by {_um(found.moved[worst])}"
    ]
    for name, feature in known.features.items():
        text = (
            f"{name}: {feature.points} points, up to {_um(found.moved[name])} off the design, "
            f"residual {_um(found.left[name])} rms; u of its position {_um(feature.u)}"
        )
        if feature.u_form:
            tilt = f"{digits(feature.u_tilt / URAD, 2)} µrad"
            text += f", of its tilt {tilt}, of its surface {_um(feature.u_form)}"
        lines.append(text)
    if found.unseen:
        lines.append(
            f"no dense line of points (up to {MAX_SPACING:g} mm apart) along both directions of "
            f"{', '.join(found.unseen)}: waves of {_um(found.waviness)} rms are assumed in each "
            "direction without one (--waviness-um)"
        )
    return [*lines, *found.remarks]


def verdict_rows(verdicts: Sequence[Verdict]) -> list[tuple[str, ...]]:
    """Feature, characteristic, deviation, tolerance, u, verdict; in µm."""
    rows: list[tuple[str, ...]] = []
    for v in verdicts:
        sign, both = ("+", "±") if v.characteristic in _SIGNED else ("", "")
        deviation, allowed = f"{v.deviation / UM:{sign}.2f}", f"{both}{v.tolerance / UM:.2f}"
        rows.append((v.feature, v.characteristic, deviation, allowed, f"{v.u / UM:.2f}", v.state))
    return rows


def refusal_sentence(verdicts: Sequence[Verdict], causes: Sequence[CommonCause]) -> str:
    """Nonconforming characteristics, their common cause, and what to do."""
    refused = [v for v in verdicts if v.is_refused]
    worst = sorted(refused, key=lambda v: v.tolerance / abs(v.deviation))
    named = [
        f"{v.feature} {v.characteristic} {_um(v.deviation)} ({_um(v.tolerance)} allowed)"
        for v in worst
    ]
    why = "; ".join(map(_cause, causes)) or "measure again, or remake the feature"
    return (
        f"{len(refused)} of {len(verdicts)} characteristics do not conform to the drawing: "
        f"{few(named, _NAMED)}; {why}; nothing is written; --accept accepts the piece as it is"
    )


def verdict_lines(verdicts: Sequence[Verdict]) -> list[str]:
    """Characteristics accepted in spite of nonconformity, and undecided ones."""
    refused = [f"{v.feature} {v.characteristic}" for v in verdicts if v.is_refused]
    undecided = [v for v in verdicts if v.state == "cannot be decided"]
    forms = sum(v.characteristic == "form" for v in undecided)
    open_ = [f"{v.feature} {v.characteristic}" for v in undecided if v.characteristic != "form"]
    # the grade of a ball is finer than a CMM
    open_ += [f"form of {forms} ball{'s' if forms > 1 else ''}"] if forms else []
    lines = [f"accepted although nonconforming: {', '.join(refused)}"] if refused else []
    if open_:
        lines.append(f"cannot be decided with this uncertainty: {', '.join(open_)}")
    return lines


def _cause(cause: CommonCause) -> str:
    """A common cause and its remedy."""
    if cause.kind == "radius":
        way = "large" if cause.value > 0.0 else "small"
        faces = (
            "the faces deviate by the same amount: the radius of the tip is"
            if cause.on_faces
            else "the faces do not: balls of another diameter, or the radius of the tip is"
        )
        return (
            f"all radii are {_um(abs(cause.value))} too {way}, to within {_um(cause.spread)}, and "
            f"{faces} compensated wrongly; qualify the stylus and measure again"
        )
    if cause.kind == "ball":
        way, alone = "large" if cause.value > 0.0 else "small", len(cause.features) == 1
        return (
            f"the radius of {listed(list(cause.features))} alone is {'' if alone else 'up to '}"
            f"{_um(abs(cause.value))} too {way}, all others are right to within "
            f"{_um(cause.spread)}: another ball than ordered, or dirt on it; clean it and measure "
            "again"
        )
    way = "long" if cause.value > 0.0 else "short"
    text = (
        f"all distances are {digits(abs(cause.value) / PPM, 3)} ppm too {way} "
        f"(u {digits(cause.spread / PPM, 2)} ppm): scale of the CMM"
    )
    if abs(cause.temperature) < _WARM:
        text += f", or a piece at {T_REF + cause.temperature:.1f} °C"
    return f"{text}; let the CMM compensate to {T_REF:g} °C and measure again"


def _um(value: float) -> str:
    return um(value, 2)


def modulus_words(material: Material) -> str:
    """Young's modulus, as used for stiffness and sag."""
    if material.modulus is None:
        return (
            f"unknown: no modulus is stated for '{material.name}'; state material.modulus_MPa. "
            f"Posts are designed for {DEFAULT_MODULUS / GPA:g} GPa, sag is not corrected"
        )
    return (
        f"{material.modulus / GPA:g} GPa, Poisson's ratio {material.poisson:g} of "
        f"'{material.name}' ({material.modulus_source})"
    )
