"""Sentences about a design: what its touches were chosen for, how it compares."""

import numpy as np

from matstd.artefact.compare import ERROR, RISK, WANTED
from matstd.artefact.place import Placement
from matstd.artefact.worth import CriterionOptions
from matstd.report.numbers import digits, percent
from matstd.twin.units import UM

_CRITERIA = {
    "I": "mean variance of the predicted tool point over probed volume and workspace",
    "G": "largest variance of the predicted tool point at any pose of probed volume and workspace",
    "D": "volume of what stays unknown of the parameters, in units of what is expected",
    "A": "mean variance of the parameters, in units of what is expected",
    "E": "variance of the least well determined error pattern, as the tool point feels it",
}

_NAMED = 4  # effects that are not found surely, by name


def criterion_words(wanted: CriterionOptions) -> str:
    """What touches were chosen for."""
    words = [_CRITERIA[wanted.name]]
    if wanted.robust_machines:
        which = (
            "" if wanted.robust_share == 1.0 else f"the worst {percent(wanted.robust_share)} of "
        )
        words.append(f"averaged over {which}{wanted.robust_machines} drawn machines")
    if wanted.potential and wanted.name == "D":
        words.append("with the effects of the library beside them")
    elif wanted.potential:
        words.append(
            f"with a share of {percent(wanted.potential)} for showing effects of the library"
        )
    return ", ".join(words)


def identification_sentence(placement: Placement) -> str:
    """What the freeform faces cost or gain in identification; empty without spheres beside them."""
    own = placement.own
    spheres = [r for r in placement.rivals[1:] if r.body is not None and not r.body.patches]
    if not spheres:
        return ""
    best = min(spheres, key=lambda r: r.rms_user)
    change = own.rms_user / best.rms_user - 1.0
    return (
        f"Identification: the freeform faces {'cost' if change > 0.0 else 'gain'} "
        f"{percent(abs(change))} over the user's workspace: after as many touches the standard "
        f"leaves {digits(own.rms_user / UM)} µm rms, {best.name} placed by the same optimiser "
        f"{digits(best.rms_user / UM)} µm, with the calibration of every feature taken in."
    )


def proof_sentence(placement: Placement) -> str:
    """What the freeform faces buy in proof, beside what the balls would."""
    faces, anywhere = placement.power, placement.power_in_volume
    balls, of_all = placement.power_of_balls, percent(float(anywhere.power.mean()))
    return (
        f"Proof: {faces.touches} touches on the {len(placement.standard.patches)} freeform faces, "
        f"held back from the identification, find a model that is wrong by {digits(ERROR / UM)} µm "
        f"rms over surfaces as steep as theirs, anywhere in the probed volume, with a power of "
        f"{percent(float(faces.power.mean()))} on average at {percent(RISK)} risk "
        f"({percent(WANTED)} or more for {faces.found} of {len(faces.effects)} effects of the "
        f"library); wrong by as much in whatever direction, with {of_all} "
        f"({anywhere.found} of {len(anywhere.effects)}). As many further touches on the balls "
        f"would find the latter for {balls.found}, but they share the calibration that went into "
        f"the model, and no ball is like the surface of a workpiece."
    )


def blind_spots(placement: Placement) -> str:
    """What the proof does not find surely, and whether calibration is to blame; empty if nothing.

    Where a face is touched at one table pose, or few, a smooth error moves the whole of it, as a
    face does that stands aside by what its calibration leaves open.
    """
    faces, exact = placement.power, placement.power_exact
    weak = np.flatnonzero(faces.power < WANTED)
    if not len(weak):
        return ""
    order = weak[np.argsort(faces.power[weak])]
    named = [f"{faces.effects[i]} ({percent(float(faces.power[i]))})" for i in order[:_NAMED]]
    more = f" and {len(weak) - _NAMED} more" if len(weak) > _NAMED else ""
    if exact.found - faces.found > 0.5 * len(weak):
        blame = "a better calibration of the faces is what helps"
    elif exact.found > faces.found:
        blame = "their calibration is one cause, their slopes and places are another"
    else:
        blame = "the touches hardly feel these effects, whatever the calibration"
    return (
        f"Found less surely than {percent(WANTED)}: {', '.join(named)}{more}. Were the places of "
        f"the faces known exactly, {exact.found} of {len(exact.effects)} effects would be found "
        f"with {percent(WANTED)} or more, {percent(float(exact.power.mean()))} on average: {blame}."
    )


def comparison_remarks(placement: Placement) -> list[str]:
    """What has to be known of the comparison with other artefacts, one line each."""
    remarks = [
        f"Not compared with: {name}; this machine can make no touch on it."
        for name in placement.unreachable
    ]
    wanted = len(placement.requests)
    return remarks + [
        f"{r.name}: {r.available} touches can be made on it, {wanted} are compared; "
        "some are made more than once."
        for r in placement.rivals
        if r.available < wanted
    ]
