"""Remarks on a run, one line each."""

from collections.abc import Callable
from typing import Any

import matstd.diagnosis.remarks as noticed
from matstd.diagnosis.fit import MistakenUnit, UnitMistake
from matstd.diagnosis.remarks import What
from matstd.report.numbers import plural, um, unit_words, with_uncertainty
from matstd.twin.library import title_of
from matstd.twin.units import T_REF, UM
from matstd.twin.words import few, listed

NONE_CERTAIN = ", but none of its effects is significant in all rows"
"""Behind a way of choosing that added nothing."""

STEEL_EXPANSION = 11e-6  # expansion of steel, 1/K

WARMED, SENSORS = 0.05, 4
"""Change of a temperature that is stated as a range, K; sensors that are named."""

LISTED = 20  # gross errors whose lines are listed


def remark_sentence(remark: noticed.Remark) -> str:
    """One line, without a full stop."""
    words = _SENTENCES[remark.what if isinstance(remark, noticed.Noticed) else type(remark)]
    return words.format(r=remark) if isinstance(words, str) else words(remark)


def memory_words(correlation: float, step: float, by_place: bool) -> str:
    """Correlation of noise, `correlation 0.82 from touch to touch`."""
    over = f"over {step:.3g} s" if step else "from touch to touch"
    return f"correlation {correlation:.2f} {over}{' at one place' if by_place else ''}"


def _body_size(r: noticed.BodySize) -> str:
    """Thermal size of the standard, and the uncertainty that it leaves in every scale."""
    of = f"the standard of {r.run}" if r.run else "the standard"
    over = f"over its {r.length:.0f} mm"
    if r.body is None:
        each = STEEL_EXPANSION * r.length / UM
        lacks = "expansion and temperature are" if r.temperature is None else "expansion is"
        at = "" if r.temperature is None else f"; T_body_degC reads {r.temperature:.1f} on average"
        return (
            f"scales hold for a standard at 20 °C: the {lacks} not stated for {of}; each kelvin of "
            f"steel changes it by {1e6 * STEEL_EXPANSION:g} ppm, {each:.1f} µm {over}{at} "
            "(`standard` in the head of the run)"
        )
    u = f"a standard uncertainty of {1e6 * r.u:.1f} ppm, {r.u * r.length / UM:.1f} µm"
    if r.temperature is None:
        return (
            f"the temperature of {of} is not stated: {T_REF:g} ± {r.body.u_temperature:g} °C is "
            f"assumed, which leaves {u} {over}, in every scale; state it as body_degC or in a "
            f"column T_body_degC; {_machine_warmth(r)}"
        )
    taken = r.strain * r.length / UM
    return (
        f"{of} was at {r.temperature:.1f} ± {r.body.u_temperature:g} °C: its growth of "
        f"{1e6 * r.strain:+.1f} ppm, {taken:+.1f} µm {over}, is corrected; {u} remains in every "
        f"scale; {_machine_warmth(r)}"
    )


def _machine_warmth(r: noticed.BodySize) -> str:
    """At which temperature a scale of the machine is that of the run."""
    if not r.machine:
        return (
            "scales of the machine hold at its temperature during the run, which is not logged "
            "(columns T_<sensor>_degC)"
        )
    logged = [
        f"{name} {low:.1f} to {high:.1f}" if high - low >= WARMED else f"{name} {low:.1f}"
        for name, low, high in r.machine
    ]
    at = few(logged, SENSORS)
    return f"scales of the machine hold at its temperatures during the run, {at} °C"


def _noise_remembers(r: noticed.Noticed) -> str:
    words = memory_words(r.correlation, r.step, r.by_place)
    count = f"{r.rows} touches count as {r.independent:.0f} independent touches"
    if r.is_noise:
        return f"the noise is correlated ({words}): for slow effects, {count}"
    return f"the residual varies slowly ({words}): in probabilities and uncertainties, {count}"


def _of_another_run(r: noticed.EffectOfOtherRun) -> str:
    inner = []
    for key, value in r.inner.items():
        name, _, unit = key.partition("_")
        inner.append(f"{name} {value:.4g} {unit}".rstrip())
    whose = f"the probe of {r.run}" if r.owner == "probe" else r.run
    size = f", where it contributed {um(r.share)} rms" if r.share else ""
    words = f"{title_of(r.effect).text} ({', '.join([r.effect.name, *inner])})"
    if r.is_repeated:
        return f"{words} was learnt from {whose}{size}: this run shows it, too, and it is applied"
    if r.is_refuted:
        return (
            f"{words} was learnt from {whose}: the touches of this run speak against it, and it is "
            "not expected here, but for an uncertainty of its size"
        )
    return f"{words} belongs to {whose}{size}: it is not applied here"


def _chosen(r: noticed.Noticed) -> str:
    tried = "; ".join(f"{name} {error / UM:.2f} µm" for name, error in r.tried)
    none = NONE_CERTAIN if r.is_empty and r.chosen != "nothing" else ""
    return (
        f"chosen by prediction: {r.chosen}{none}. Error of {r.blocks} blocks left out in turn, "
        f"with the choice repeated without each: {tried}"
    )


def _field_shares(r: noticed.Noticed) -> str:
    words = ", ".join(f"{drive} {size / UM:.1f}" for drive, size in r.sizes)
    return (
        f"the thermal field of {r.axis} follows {words} µm rms, which partly cancel; correlated "
        "sensors replace one another, so their order has no meaning"
    )


def _joints_stood(r: noticed.Noticed) -> str:
    return (
        f"{listed([*r.names])} did not move in any pose: their errors cannot be determined and are "
        "part of the position of the reflector"
    )


def _jump_in_order(r: noticed.JumpInOrder) -> str:
    size = with_uncertainty(r.size / UM, r.u / UM)
    return (
        f"between lines {r.before} and {r.after} all deviations shift by {size} µm: if the rows "
        "are in the order of measurement, something slipped there; with times (column time_s, or "
        "--in-order of matstd import) the diagnosis can decide"
    )


def _few_poses(r: noticed.Noticed) -> str:
    if not r.has_rotary:
        return f"only {plural(r.poses, 'pose')}: rows are held out in blocks instead of by pose"
    return (
        f"only {plural(r.poses, 'table pose')}: errors of the rotary axes "
        f"{'can hardly' if r.poses > 1 else 'cannot'} be determined, and touches are held out in "
        "blocks instead of by pose"
    )


def _noise_misstated(r: noticed.Noticed) -> str:
    return (
        f"touches scatter by {r.found / UM:.2f} µm about the model; the stated noise is "
        f"{r.stated / UM:.2f} µm"
    )


def _many_stood_out(r: noticed.Noticed) -> str:
    share = f"{r.touches} of {r.of} touches are outliers ({100.0 * r.touches / r.of:.0f} %)"
    why = (
        "scattered, of all sizes and far from the rest, like accidental errors"
        if r.left_out
        else "too similar, too close together or too many for accidental errors"
    )
    return (
        f"{share}, {why}: held-out error {r.without / UM:.2f} µm without them, "
        f"{r.whole / UM:.2f} µm with all touches"
    )


def _outliers_left_out(r: noticed.Noticed) -> str:
    count = len(r.lines)
    several = count > 1
    side = "outside" if r.largest > 0 else "inside"
    shown: dict[str, list[int]] = {}
    for line, run in zip(r.lines[:LISTED], r.runs or ("",) * count, strict=False):
        shown.setdefault(run, []).append(line)
    lines = "; ".join(
        f"line{'s' if len(some) > 1 else ''} {', '.join(map(str, some))}" + (run and f" of {run}")
        for run, some in shown.items()
    )
    more = f" and {count - LISTED} more" if count > LISTED else ""
    return (
        f"{count} gross error{'s were' if several else ' was'} left out, "
        f"{'the largest ' if several else ''}{abs(r.largest) / UM:.1f} µm {side} the prediction of "
        f"the other touches: {lines}{more}"
    )


def off_sentence(r: noticed.OffTogether) -> str:
    """A feature whose touches are off together, and what to do, without a full stop."""
    side, size = "outside" if r.size > 0 else "inside", with_uncertainty(abs(r.size) / UM, r.u / UM)
    of = f" in {r.run}" if r.run else ""
    off = f"{len(r.lines)} of {plural(r.of, 'touch')} on {r.feature}{of} lie {size} µm {side}"
    if r.is_whole:
        return f"{off}: clean {r.feature}, or check its calibration"
    at = ", ".join(f"{x:.0f}" for x in r.place)
    return f"{off}, about ({at}) mm on the standard: look for dirt or a chip there"


def _off_together(r: noticed.OffTogether) -> str:
    lines = few([str(line) for line in r.lines], LISTED)
    return f"{off_sentence(r)}; they are left out: lines {lines}"


def _not_significant(r: noticed.Noticed) -> str:
    size = with_uncertainty(r.value, r.u, unit_words(r.unit))
    return (
        f"{r.effect} was added by name, but its size is not significant: {r.quantity} {size}; "
        "this run does not support it"
    )


def _units(r: UnitMistake) -> str:
    usual = f"{_shown(r.measured)}, those of such a machine {_shown(r.expected)}"
    stated = f"the stated uncertainty of a touch is {_shown(r.stated)}"
    match r.what:
        case MistakenUnit.DEVIATIONS_IN_NM | MistakenUnit.BOTH_IN_NM:
            both = r.what is MistakenUnit.BOTH_IN_NM
            what = "deviations and uncertainties" if both else "deviations"
            return (
                f"typical deviations are {usual}: the {what} look like nm in a column of µm, or "
                "set-up, probe or machine differ from those stated"
            )
        case MistakenUnit.DEVIATIONS_IN_MM:
            what = "the deviations look like mm in a column of µm"
            return f"typical deviations are {usual}, and {stated}: {what}"
        case MistakenUnit.BOTH_IN_MM:
            what = "deviations and uncertainties look like mm in columns of µm"
            return f"typical deviations are {usual}, and {stated}: {what}"
        case MistakenUnit.UNCERTAINTIES_IN_NM:
            return f"{stated}, but typical deviations are {usual}: u_um looks like nm"
        case MistakenUnit.UNCERTAINTIES_IN_MM:
            return (
                f"{stated}, but touches scatter by {_shown(r.scatter)} about the model: u_um "
                "looks like mm"
            )


def _shown(size: float) -> str:
    """`12 µm`, two digits."""
    return f"{float(f'{size / UM:.2g}'):g} µm"


def _harmonics_alike(r: noticed.HarmonicsAlike) -> str:
    if not r.found:
        return (
            f"{r.targets} evenly spaced targets per turn of {r.axis} show errors that repeat more "
            f"than {r.targets // 2} times per turn, such as those of a worm, as slower ones; "
            "unevenly spaced targets avoid this"
        )
    return (
        f"{r.targets} evenly spaced targets per turn of {r.axis} cannot distinguish harmonic "
        f"{r.found} from {listed([str(h) for h in r.others], 'or')}, such as those of a worm or of "
        "teeth; unevenly spaced targets can"
    )


_SENTENCES: dict[type | What, str | Callable[[Any], str]] = {
    UnitMistake: _units,
    noticed.BodySize: _body_size,
    What.NOISE_REMEMBERS: _noise_remembers,
    What.CHOSEN_BY_PREDICTION: _chosen,
    What.FIELD_SHARES: _field_shares,
    noticed.EffectOfOtherRun: _of_another_run,
    What.READER: "{r.text}",
    What.FEW_TOUCHES: "{r.touches} touches for {r.parameters} possible errors of the machine: "
    "the expected sizes determine the rest; not the single errors are known, but their sum where "
    "the machine was probed",
    What.FEW_DEGREES_OF_FREEDOM: "only {r.dof:.0f} degrees of freedom remain for the noise: only "
    "large effects can be detected, and the stated uncertainty is used",
    What.HELD_OUT_IN_DOUBT: "the error of held-out touches is {r.ratio:.1f} times the stated "
    "noise, with too few touches to decide whether an effect is missing: probe more",
    What.FEW_POSES: _few_poses,
    What.JOINTS_STOOD: _joints_stood,
    noticed.JumpInOrder: _jump_in_order,
    What.WORSE_THAN_REPLICATES: "residuals are {r.ratio:.2f} times as large as the scatter of "
    "{r.dof} replicates: the model is incomplete",
    What.NOISE_MISSTATED: _noise_misstated,
    What.OUTLIERS_KEPT: "more touches are outliers than accidental errors can explain: all were "
    "kept, and the residual is treated as a pattern",
    What.OUTLIERS_LEFT_OUT: _outliers_left_out,
    What.MANY_STOOD_OUT: _many_stood_out,
    What.PRIOR_WIDENED: "the errors of the machine are about {r.factor:.1f} times as large as "
    "stated; the prior was widened by this factor",
    What.SHORT_BEAM: "{r.effect} is at most {r.slenderness:.1f} times as long as deep: beam "
    "theory is doubtful there, and the compliance of its support matters as much",
    What.LOAD_TOO_SMALL: "loads of up to {r.load:.3g} N are too small to identify {r.effect}: "
    "its numbers are the prior ones; load the tool with about 100 N",
    What.FIXING_NOT_STATED: "{r.effect}: the standard is taken to expand together with the table, "
    "from the origin of the table frame. If it is held elsewhere and expands alone, state the "
    "point: fixing_mm in [setup.NAME] of the run",
    What.SEARCH_ENDED: "the search was stopped after {r.sets:.0f} sets of effects: the reported "
    "effects passed every test, but another set may explain more",
    noticed.OffTogether: _off_together,
    What.NOT_SIGNIFICANT: _not_significant,
    noticed.HarmonicsAlike: _harmonics_alike,
}
"""For each kind of remark a text with its fields, or a function that makes one."""
