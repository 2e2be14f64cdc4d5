"""What was noticed about a run, one clear line each."""

from collections.abc import Callable
from typing import Any

import matstd.diagnosis.remarks as noticed
from matstd.diagnosis.fit import MistakenUnit, UnitMistake
from matstd.report.numbers import digits, unit_words, with_uncertainty
from matstd.twin.library import title_of
from matstd.twin.units import T_REF, UM
from matstd.twin.words import listed

NONE_CERTAIN = ", none of which stands with all rows in use"
"""Behind a way of choosing of which nothing came."""

STEEL = 11e-6
"""Expansion of steel, 1/K."""

LISTED = 20
"""Gross errors whose lines are told."""


def remark_sentence(remark: noticed.Remark) -> str:
    """One line about what was noticed, without a full stop."""
    told = _SENTENCES[type(remark)]
    return told.format(r=remark) if isinstance(told, str) else told(remark)


def memory_words(correlation: float, step: float, by_place: bool) -> str:
    """What noise remembers, `correlation 0.82 from touch to touch`."""
    over = f"over {step:.3g} s" if step else "from touch to touch"
    return f"correlation {correlation:.2f} {over}{' at one place' if by_place else ''}"


def _body_size(r: noticed.BodySize) -> str:
    """How large the standard was, and what that leaves open in every scale."""
    of = f"the standard of {r.run}" if r.run else "the standard"
    over = f"over its {r.length:.0f} mm"
    if r.body is None:
        each = STEEL * r.length / UM
        lacks = "expansion and temperature are" if r.temperature is None else "expansion is"
        at = "" if r.temperature is None else f"; T_body_degC reads {r.temperature:.1f} on average"
        return (
            f"scales hold for a standard at 20 °C: of {of} the {lacks} not stated, and every "
            f"kelvin of steel is {1e6 * STEEL:g} ppm, {each:.1f} µm {over}{at} (`standard` in the "
            "head of the run)"
        )
    u = f"a standard uncertainty of {1e6 * r.u:.1f} ppm, {r.u * r.length / UM:.1f} µm"
    if r.temperature is None:
        return (
            f"the temperature of {of} is not stated: {T_REF:g} ± {r.body.u_temperature:g} °C is "
            f"assumed, which leaves {u} {over}, in every scale; body_degC or a column T_body_degC "
            "states it"
        )
    taken = r.strain * r.length / UM
    return (
        f"{of} was at {r.temperature:.1f} ± {r.body.u_temperature:g} °C: its growth of "
        f"{1e6 * r.strain:+.1f} ppm, {taken:+.1f} µm {over}, is taken off; {u} stays in every scale"
    )


def _noise_remembers(r: noticed.NoiseRemembers) -> str:
    words = memory_words(r.correlation, r.step, r.by_place)
    count = f"{r.rows} touches count as {r.independent:.0f} independent ones"
    if r.is_noise:
        return f"the noise remembers ({words}): for everything slow, {count}"
    return f"what is left is slow ({words}): in probabilities and uncertainties {count}"


def _of_another_run(r: noticed.OfAnotherRun) -> str:
    inner = []
    for key, value in r.inner.items():
        name, _, unit = key.partition("_")
        inner.append(f"{name} {value:.4g} {unit}".rstrip())
    whose = f"the probe of {r.run}" if r.owner == "probe" else r.run
    made = f", where it made {digits(r.share / UM)} µm rms" if r.share else ""
    words = f"{title_of(r.effect).text} ({', '.join([r.effect.name, *inner])})"
    return f"{words} belongs to {whose}{made}: it is not applied here"


def _chosen(r: noticed.ChosenByPrediction) -> str:
    tried = "; ".join(f"{name} {error / UM:.2f} µm" for name, error in r.tried)
    none = NONE_CERTAIN if r.is_empty and r.chosen != "nothing" else ""
    return (
        f"chosen by prediction: {r.chosen}{none}. Plain error of {r.blocks} blocks left out in "
        f"turn, the choice made anew without each: {tried}"
    )


def _field_shares(r: noticed.FieldShares) -> str:
    words = ", ".join(f"{drive} {size / UM:.1f}" for drive, size in r.sizes)
    return (
        f"the field of {r.axis} follows {words} µm rms, which partly cancel; sensors that share "
        "what they know stand in for one another, so their order is no finding"
    )


def _joints_stood(r: noticed.JointsStood) -> str:
    them, what = ("it", "it does") if len(r.names) == 1 else ("them", "they do")
    return (
        f"{listed([*r.names])} stood still in all poses: nothing is known of {them}, and what "
        f"{what} wrong is part of where the reflector sits"
    )


def _jump_in_order(r: noticed.JumpInOrder) -> str:
    size = with_uncertainty(r.size / UM, r.u / UM)
    return (
        f"between lines {r.before} and {r.after} everything is displaced by {size} µm: if rows "
        "stand in the order in which they were taken, something slipped there; with times (column "
        "time_s, or --in-order of matstd import) the diagnosis can tell"
    )


def _few_poses(r: noticed.FewPoses) -> str:
    several = r.poses > 1
    if not r.has_rotary:
        return f"{r.poses} pose{'s' if several else ''} only: rows are held out in blocks instead"
    return (
        f"{r.poses} table pose{'s' if several else ''} only: errors of the rotary axes "
        f"{'can hardly' if several else 'cannot'} be seen, and touches are held out in blocks "
        "instead of by pose"
    )


def _noise_misstated(r: noticed.NoiseMisstated) -> str:
    return (
        f"touches scatter by {r.found / UM:.2f} µm about the model; {r.stated / UM:.2f} µm is "
        "stated"
    )


def _many_stood_out(r: noticed.ManyStoodOut) -> str:
    share = f"{r.touches} of {r.of} touches stand out ({100.0 * r.touches / r.of:.0f} %)"
    why = (
        "scattered, of all sizes and far from the rest, as accidents are"
        if r.left_out
        else "alike, together or too many for accidents"
    )
    return (
        f"{share}, {why}: held-out error {r.without / UM:.2f} µm without them, "
        f"{r.whole / UM:.2f} µm with all touches"
    )


def _outliers_left_out(r: noticed.OutliersLeftOut) -> str:
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
        f"{'the largest ' if several else ''}{abs(r.largest) / UM:.1f} µm {side} what the other "
        f"touches predict: {lines}{more}"
    )


def _not_significant(r: noticed.NotSignificant) -> str:
    size = with_uncertainty(r.value, r.u, unit_words(r.unit))
    return (
        f"{r.effect} was added by name, but its size is not significant: {r.quantity} {size}; "
        "this run gives no reason to keep it"
    )


def _units(r: UnitMistake) -> str:
    usual = f"{_shown(r.measured)}, a machine like this shows {_shown(r.expected)}"
    stated = f"a touch is stated to be uncertain by {_shown(r.stated)}"
    match r.what:
        case MistakenUnit.DEVIATIONS_IN_NM | MistakenUnit.BOTH_IN_NM:
            both = r.what is MistakenUnit.BOTH_IN_NM
            what = "deviations and uncertainties" if both else "deviations"
            return (
                f"typical deviations are {usual}: the {what} look like nm in a column of µm, or "
                "set-up, probe or machine are others than stated"
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
            f"{r.targets} even targets a turn of {r.axis} show whatever repeats more than "
            f"{r.targets // 2} times a turn, such as a worm, as something slower: targets that "
            "stand unevenly tell"
        )
    return (
        f"{r.targets} even targets a turn of {r.axis} cannot tell harmonic {r.found} from "
        f"{listed([str(h) for h in r.others], 'or')}: a worm or teeth may as well be behind it; "
        "targets that stand unevenly tell"
    )


_SENTENCES: dict[type, str | Callable[[Any], str]] = {
    UnitMistake: _units,
    noticed.BodySize: _body_size,
    noticed.NoiseRemembers: _noise_remembers,
    noticed.ChosenByPrediction: _chosen,
    noticed.FieldShares: _field_shares,
    noticed.OfAnotherRun: _of_another_run,
    noticed.ReaderRemark: "{r.text}",
    noticed.FewTouches: "{r.touches} touches for {r.parameters} errors that the machine may have "
    "there: what is usual decides the rest; single ones are not known, only what they do together "
    "where it was probed",
    noticed.FewDegreesOfFreedom: "{r.dof:.0f} degrees of freedom are left for the noise: only "
    "large effects can be seen, and the stated uncertainty is relied on",
    noticed.HeldOutInDoubt: "the error of held-out touches is {r.ratio:.1f} times the stated "
    "noise, with too few touches to say whether anything is missing: probe more",
    noticed.FewPoses: _few_poses,
    noticed.JointsStood: _joints_stood,
    noticed.JumpInOrder: _jump_in_order,
    noticed.WorseThanReplicates: "residuals are {r.ratio:.2f} times as large as the scatter of "
    "{r.dof} replicates: the model lacks something",
    noticed.NoiseMisstated: _noise_misstated,
    noticed.OutliersKept: "more touches stand out than accidents can explain: all were kept, and "
    "the residual is treated as structure",
    noticed.OutliersLeftOut: _outliers_left_out,
    noticed.ManyStoodOut: _many_stood_out,
    noticed.PriorWidened: "the machine's errors are about {r.factor:.1f} times their stated "
    "distributions; the prior was widened by that",
    noticed.ShortBeam: "{r.effect} is {r.slenderness:.1f} times as long as deep at most: the "
    "theory of beams is doubtful there, what holds the body counts as much",
    noticed.LoadTooSmall: "loads of up to {r.load:.3g} N bend too little to identify {r.effect}: "
    "its numbers are what was believed beforehand; load the tool with some 100 N",
    noticed.SearchEnded: "the search was ended after {r.sets:.0f} sets of effects: what is named "
    "passed every test, but another set may explain more",
    noticed.NotSignificant: _not_significant,
    noticed.HarmonicsAlike: _harmonics_alike,
}
"""What is told of each kind of remark: a text with its fields, or a function that makes one."""
