"""Sentences on a design: what remains unknown of the machine after its touches, and after others.

The user's workspace comes first, because parts are made there. The probed volume, the box that the
ball reaches on the standard, comes second.
"""

from collections.abc import Mapping

import numpy as np

from matstd.artefact.compare import DETECTION_POWER, FALSE_ALARM, MODEL_ERROR, Rival, WorstRegions
from matstd.artefact.place import Placement
from matstd.diagnosis.accuracy import Proof
from matstd.diagnosis.fit import Fit
from matstd.report.numbers import digits, percent, um
from matstd.report.words.family_words import family_line, proving_words
from matstd.twin.numbers import rms
from matstd.twin.units import DEG
from matstd.twin.words import few, listed

_NEGLIGIBLE_SHARE = 5e-4  # of the error that remains unknown
_NAMED = 4  # effects of low power that are named

COVERED, NEARLY_ALL, FAR = 0.5, 0.9, 3.0
"""Share of the workspace of an axis below which the touches do not cover it: half, or nearly all
where the workspace is known so many times worse than the probed volume."""

_ALONG_SPINDLE = 0.7  # cosine above which an axis turns about the spindle: half a right angle

AT_20 = "This holds for a standard at 20 °C, or corrected with its known temperature."
"""Condition of every figure of a design: 1 K of steel is 3 µm over 300 mm."""

EQUAL = 1.05
"""Ratio up to which two predicted errors count as equal: no user would notice the difference."""


def best_rival(placement: Placement) -> Rival | None:
    """The other artefact that can be built and has the smallest error in the workspace."""
    return min(_rivals(placement), key=lambda r: r.rms_user, default=None)


def _rivals(placement: Placement) -> list[Rival]:
    return [r for r in placement.rivals if r is not placement.own and r.body is not None]


def verdict_of_design(placement: Placement, workspace: Mapping[str, tuple[float, float]]) -> str:
    """Error that remains in the user's workspace, beside the best rival, and axes not covered.

    Args:
        workspace: Smallest and largest reading by axis, mm or rad.
    """
    words = [_remaining(placement), _extrapolated(placement, workspace), AT_20]
    return " ".join(filter(None, words))


def _remaining(placement: Placement) -> str:
    own, rival = placement.own, best_rival(placement)
    text = (
        f"After probing the {own.name}, the tool point is known to {um(own.rms_user)} rms in your "
        "workspace"
    )
    if rival is None:
        return f"{text} (predicted)."
    ratio, left = rival.rms_user / own.rms_user, um(rival.rms_user)
    if ratio >= EQUAL:
        return (
            f"{text}; the best other artefact, {rival.name}, would leave {left}, "
            f"{digits(ratio, 2)} times as much (both predicted)."
        )
    if ratio > 1.0 / EQUAL:
        return f"{text}; the best other artefact, {rival.name}, is equal: {left} (both predicted)."
    return (
        f"{text}. Another artefact is better there: {rival.name} would leave {left}, "
        f"{digits(1.0 / ratio, 2)} times less (both predicted)."
    )


def _extrapolated(placement: Placement, workspace: Mapping[str, tuple[float, float]]) -> str:
    """Axes whose workspace the touches do not cover; empty for none."""
    if not workspace:
        return ""
    reach, parts, heads = placement.criterion.reach, [], []
    q, own = reach.readings(placement.requests), placement.own
    least = NEARLY_ALL if own.rms_user > FAR * own.rms else COVERED
    for name, (low, high) in workspace.items():
        link, read = reach.chain.link(name), q[:, reach.chain.axis_index(name)]
        first, last = max(low, float(read.min())), min(high, float(read.max()))
        if last - first < least * (high - low):
            unit, sign = (1.0, " mm") if link.kind == "linear" else (DEG, "°")
            ends = [f"{round(v / unit) + 0.0:.0f}" for v in (read.min(), read.max(), low, high)]
            # an axis of a head along the spindle tilts nothing
            is_tilting = abs(float(link.direction[2])) < _ALONG_SPINDLE
            heads += [name] * (is_tilting and name in reach.chain.tool_rotary_axes)
            parts.append(f"{name} {ends[0]} to {ends[1]}{sign} (workspace {ends[2]} to {ends[3]})")
    if not parts:
        return ""
    ways = ["a smaller workspace", "further set-ups"]
    if heads:  # over a low standard the end of Z limits the tilt in every set-up
        ways.append(f"for {listed(heads)} a riser under the standard")
    return (
        f"The touches cover only {listed(parts)}. Beyond these readings the model extrapolates "
        f"with the assumed shapes of the errors; {listed(ways, 'or')} reduce the uncertainty."
    )


def design_lines(placement: Placement, workspace: Mapping[str, tuple[float, float]]) -> list[str]:
    """What is built, the verdict, the error in the volume, what the faces cost identification."""
    line = f"in the probed volume the tool point is known to {um(placement.own.rms)} rms"
    rival = min(_rivals(placement), key=lambda r: r.rms, default=None)
    if rival is not None:
        line += f"; the best other artefact there, {rival.name}, would leave {um(rival.rms)}"
    verdict = verdict_of_design(placement, workspace)
    lines = [family_line(placement), verdict, line, identification_sentence(placement)]
    return [words for words in lines if words]


def identification_lines(placement: Placement, worst: WorstRegions) -> list[str]:
    """Which features are built, and what the faces cost or gain, detect, and miss."""
    words = (
        family_line(placement),
        identification_sentence(placement),
        proof_sentence(placement),
        blind_spots(placement),
        regions_sentence(worst),
    )
    return [line for line in words if line]


def identification_sentence(placement: Placement) -> str:
    """What the features that prove cost or gain in identification; empty without rival spheres."""
    own = placement.own
    spheres = [r for r in placement.rivals[1:] if r.body is not None and not r.body.patches]
    if not spheres:
        return ""
    best = min(spheres, key=lambda r: r.rms_user)
    change = own.rms_user / best.rms_user - 1.0
    return (
        f"Identification: {proving_words(placement.standard, placement.family)} "
        f"{_cost_or_gain(placement, change)} over your workspace. With the same number of "
        f"touches, the standard leaves {um(own.rms_user)} rms; {best.name}, placed by the same "
        f"optimiser, leave {um(best.rms_user)}. The calibration uncertainty of every feature is "
        "included."
    )


def _cost_or_gain(placement: Placement, change: float) -> str:
    verb = "cost" if change > 0.0 else "gain"
    verb += "s" if len(placement.standard.proving) == 1 else ""
    return (
        f"{verb} {percent(abs(change))}" if abs(change) > _NEGLIGIBLE_SHARE else f"{verb} nothing"
    )


def proof_sentence(placement: Placement) -> str:
    """Power of what proves to detect a wrong model, compared with more touches on balls."""
    faces, anywhere = placement.power, placement.power_in_volume
    balls, of_all = placement.power_of_balls, percent(float(anywhere.power.mean()))
    has_faces = bool(placement.standard.patches)
    unlike = ", and no ball resembles the surface of a workpiece" if has_faces else ""
    return (
        f"Proof: {faces.touches} touches on {proving_words(placement.standard, placement.family)}, "
        f"not used for identification, detect a model that is wrong by {um(MODEL_ERROR)} rms "
        f"on surfaces of the same slopes, anywhere in the probed volume, with an average power of "
        f"{percent(float(faces.power.mean()))} at {percent(FALSE_ALARM)} risk "
        f"({percent(DETECTION_POWER)} or more for {faces.found} of {len(faces.effects)} effects "
        f"of the library). For errors of this size in any direction the power is {of_all} "
        f"({anywhere.found} of {len(anywhere.effects)} "
        f"effects). The same number of further touches on the balls that identify "
        f"would detect {balls.found} of these, but they share the calibration on which the model "
        f"rests{unlike}."
    )


def blind_spots(placement: Placement) -> str:
    """Effects that the proof detects with low power, and whether calibration is the cause.

    Where a face is touched at one table pose, or few, a smooth error displaces the whole face, as
    the uncertainty of its calibrated position does.
    """
    faces, exact = placement.power, placement.power_exact
    weak = np.flatnonzero(faces.power < DETECTION_POWER)
    if not len(weak):
        return ""
    order = weak[np.argsort(faces.power[weak])]
    named = [f"{faces.effects[i]} ({percent(float(faces.power[i]))})" for i in order]
    if exact.found - faces.found > 0.5 * len(weak):
        cause = "a better calibration of these features would help"
    elif exact.found > faces.found:
        cause = "their calibration is one cause, their slopes and places are another"
    else:
        cause = "the touches are hardly sensitive to these effects, whatever the calibration"
    return (
        f"Power below {percent(DETECTION_POWER)}: {few(named, _NAMED)}. With exactly known "
        f"positions of {proving_words(placement.standard, placement.family)}, {exact.found} of "
        f"{len(exact.effects)} effects would be detected with {percent(DETECTION_POWER)} or more, "
        f"{percent(float(exact.power.mean()))} on average: {cause}."
    )


def regions_sentence(worst: WorstRegions) -> str:
    """What the proof determines where random machines are most often among the worst."""
    return (
        f"At the {worst.poses} poses of your workspace that are most often among the worst 5 % "
        f"({100 * worst.recurrence:.0f} % of random machines each, on average), the touches "
        f"that prove alone reduce the expected error from {um(worst.before)} to "
        f"{um(worst.after)}. At {100 * worst.covered:.0f} % of these poses at most a tenth of the "
        "error remains."
    )


def comparison_remarks(placement: Placement) -> list[str]:
    """Limits of the comparison with other artefacts, one line each."""
    remarks = [
        f"Not compared with: {name}; this machine cannot make any touch on it."
        for name in placement.unreachable
    ]
    wanted = len(placement.requests)
    return remarks + [
        f"{r.name}: only {r.available} different touches are possible; some of the {wanted} "
        "compared touches are repeated."
        for r in placement.rivals
        if r.available < wanted
    ]


def proof_line(number: int, in_workspace: Proof, in_volume: Proof, fit: Fit) -> str:
    """One simulated machine: the error that its model does not predict."""
    held_back = fit.test_rows
    left, noise = (rms(v[held_back]) if held_back.any() else 0.0 for v in (fit.residual, fit.run.u))
    proof = f"; residual of the touches held out {um(left)} rms, noise {um(noise)}" if left else ""
    return (
        f"machine {number}: in your workspace {_after(in_workspace)}; "
        f"in the probed volume {_after(in_volume)}{proof}"
    )


def _after(proof: Proof) -> str:
    return (
        f"{um(proof.rms_before)} rms, not predicted {um(proof.rms_after)} (stated uncertainty "
        f"{um(proof.rms_u)}), {digits(proof.factor, 2)} times smaller"
    )
