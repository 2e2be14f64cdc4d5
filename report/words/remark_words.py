"""What was noticed about a run, one clear line each."""

from collections.abc import Callable
from typing import Any

from diagnosis.fit import MistakenUnit, UnitMistake
from diagnosis.remarks import (
    ChosenByPrediction,
    FewDegreesOfFreedom,
    FewPoses,
    FewTouches,
    FieldShares,
    HeldOutInDoubt,
    NoiseMisstated,
    NoiseRemembers,
    NotSignificant,
    OutliersKept,
    OutliersLeftOut,
    PriorWidened,
    ReaderRemark,
    Remark,
    SearchEnded,
    WorseThanReplicates,
)
from report.numbers import unit_words, with_uncertainty
from twin.units import UM

LISTED = 20
"""Gross errors whose lines are told."""


def remark_sentence(remark: Remark) -> str:
    """One line about what was noticed, without a full stop."""
    return _SENTENCES[type(remark)](remark)


def memory_words(correlation: float, step: float, by_place: bool) -> str:
    """What noise remembers, `correlation 0.82 from touch to touch`."""
    over = f"over {step:.3g} s" if step else "from touch to touch"
    return f"correlation {correlation:.2f} {over}{' at one place' if by_place else ''}"


def _noise_remembers(r: NoiseRemembers) -> str:
    words = memory_words(r.correlation, r.step, r.by_place)
    count = f"{r.rows} touches count as {r.independent:.0f} independent ones"
    if r.is_noise:
        return f"the noise remembers ({words}): for everything slow, {count}"
    return f"what is left is slow ({words}): in probabilities and uncertainties {count}"


def _chosen(r: ChosenByPrediction) -> str:
    ways = "; ".join(f"{name} {error / UM:.2f} µm" for name, error in r.ways)
    return (
        f"chosen by prediction: {r.chosen}. Plain error of {r.blocks} blocks left out in turn, the "
        f"choice made anew without each: {ways}"
    )


def _field_shares(r: FieldShares) -> str:
    words = ", ".join(f"{drive} {size / UM:.1f}" for drive, size in r.sizes)
    return (
        f"the field of {r.axis} follows {words} µm rms, which partly cancel; sensors that share "
        "what they know stand in for one another, so their order is no finding"
    )


def _few_touches(r: FewTouches) -> str:
    return (
        f"{r.touches} touches for {r.parameters} parameters: the prior decides the rest; single "
        "parameters are not known, only what they do together where it was probed"
    )


def _few_dof(r: FewDegreesOfFreedom) -> str:
    return (
        f"{r.dof:.0f} degrees of freedom are left for the noise: only large effects can be seen, "
        "and the stated uncertainty is relied on"
    )


def _held_out_in_doubt(r: HeldOutInDoubt) -> str:
    return (
        f"the error of held-out touches is {r.ratio:.1f} times the stated noise, with too few "
        "touches to say whether anything is missing: probe more"
    )


def _few_poses(r: FewPoses) -> str:
    several = r.poses > 1
    if not r.has_rotary:
        return f"{r.poses} pose{'s' if several else ''} only: rows are held out in blocks instead"
    return (
        f"{r.poses} table pose{'s' if several else ''} only: errors of the rotary axes "
        f"{'can hardly' if several else 'cannot'} be seen, and touches are held out in blocks "
        "instead of by pose"
    )


def _worse_than_replicates(r: WorseThanReplicates) -> str:
    return (
        f"residuals are {r.ratio:.2f} times as large as the scatter of {r.dof} replicates: the "
        "model lacks something"
    )


def _noise_misstated(r: NoiseMisstated) -> str:
    return (
        f"touches scatter by {r.found / UM:.2f} µm about the model; {r.stated / UM:.2f} µm is "
        "stated"
    )


def _outliers_kept(_: OutliersKept) -> str:
    return (
        "more touches stand out than accidents can explain: all were kept, and the residual is "
        "treated as structure"
    )


def _outliers_left_out(r: OutliersLeftOut) -> str:
    count = len(r.lines)
    several = count > 1
    side = "outside" if r.largest > 0 else "inside"
    lines = ", ".join(str(line) for line in r.lines[:LISTED])
    more = f" and {count - LISTED} more" if count > LISTED else ""
    return (
        f"{count} gross error{'s were' if several else ' was'} left out, "
        f"{'the largest ' if several else ''}{abs(r.largest) / UM:.1f} µm {side} what the other "
        f"touches predict: line{'s' if several else ''} {lines}{more}"
    )


def _prior_widened(r: PriorWidened) -> str:
    return (
        f"the machine's errors are about {r.factor:.1f} times their stated distributions; the "
        "prior was widened by that"
    )


def _search_ended(r: SearchEnded) -> str:
    return (
        f"the search was ended after {r.sets:.0f} sets of effects: what is named passed every "
        "test, but another set may explain more"
    )


def _not_significant(r: NotSignificant) -> str:
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


_SENTENCES: dict[type, Callable[[Any], str]] = {
    UnitMistake: _units,
    NoiseRemembers: _noise_remembers,
    ChosenByPrediction: _chosen,
    FieldShares: _field_shares,
    ReaderRemark: lambda r: r.text,
    FewTouches: _few_touches,
    FewDegreesOfFreedom: _few_dof,
    HeldOutInDoubt: _held_out_in_doubt,
    FewPoses: _few_poses,
    WorseThanReplicates: _worse_than_replicates,
    NoiseMisstated: _noise_misstated,
    OutliersKept: _outliers_kept,
    OutliersLeftOut: _outliers_left_out,
    PriorWidened: _prior_widened,
    SearchEnded: _search_ended,
    NotSignificant: _not_significant,
}
