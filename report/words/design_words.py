"""What is said of a design: what the standard leaves unknown of the machine, and what others leave.

The user's workspace comes first, because that is where parts are made; the probed volume, the box
that the ball reaches on the standard, comes second and is named as such.
"""

from collections.abc import Mapping

from matstd.artefact.compare import Rival, WorstRegions
from matstd.artefact.place import Placement
from matstd.diagnosis.answer import Proof
from matstd.diagnosis.fit import Fit
from matstd.report.numbers import digits
from matstd.report.words.artefact_words import blind_spots, identification_sentence, proof_sentence
from matstd.twin.numbers import rms
from matstd.twin.units import DEG, UM
from matstd.twin.words import listed

COVERED, FAR = 0.5, 3.0
"""Least share of the workspace of an axis that touches read for nothing to be said; where the
workspace is known so many times worse than the probed volume, nearly all of it has to be read."""

_NEARLY_ALL = 0.9

AT_20 = "That holds for a standard at 20 °C, or corrected by its known temperature."
"""What every figure of a design supposes: 1 K of steel is 3 µm over 300 mm."""

EQUAL = 1.05
"""Ratio of two predicted errors up to which they are called equal: no user would notice it."""


def best_rival(placement: Placement) -> Rival | None:
    """The other artefact that somebody could build and that leaves least in the workspace."""
    others = [r for r in placement.rivals if r is not placement.own and r.body is not None]
    return min(others, key=lambda r: r.rms_user, default=None)


def verdict_of_design(placement: Placement, workspace: Mapping[str, tuple[float, float]]) -> str:
    """What the standard leaves in the user's workspace, beside the best rival.

    Said as well: axes of which the touches read only a small part.

    Args:
        placement: Standard, touches, rivals.
        workspace: Smallest and largest reading by axis, mm or rad.
    """
    told = [_left_unknown(placement), _extrapolated(placement, workspace), AT_20]
    return " ".join(filter(None, told))


def _left_unknown(placement: Placement) -> str:
    own, rival = placement.own, best_rival(placement)
    text = (
        f"After probing the {own.name}, {_um(own.rms_user)} rms of the volumetric error stay "
        f"unknown in your workspace"
    )
    if rival is None:
        return f"{text} (predicted)."
    ratio = rival.rms_user / own.rms_user
    if ratio >= EQUAL:
        return (
            f"{text}; the best other artefact, {rival.name}, would leave {_um(rival.rms_user)}, "
            f"{digits(ratio, 2)} times as much (both predicted)."
        )
    if ratio > 1.0 / EQUAL:
        return (
            f"{text}, as much as after probing the best other artefact, {rival.name}: "
            f"{_um(rival.rms_user)}."
        )
    return (
        f"{text}. That is not the best there: {rival.name} would leave {_um(rival.rms_user)}, "
        f"{digits(1.0 / ratio, 2)} times less."
    )


def _extrapolated(placement: Placement, workspace: Mapping[str, tuple[float, float]]) -> str:
    """Which axes the touches read over a small part of the workspace; empty for none.

    Beyond its touches a model only carries on the shapes that were assumed for the errors.
    """
    if not workspace:
        return ""
    reach, parts = placement.criterion.reach, []
    q, own = reach.readings(placement.requests), placement.own
    least = _NEARLY_ALL if own.rms_user > FAR * own.rms else COVERED
    for name, (low, high) in workspace.items():
        link, read = reach.chain.link(name), q[:, reach.chain.axis_index(name)]
        first, last = max(low, float(read.min())), min(high, float(read.max()))
        if last - first < least * (high - low):
            unit, sign = (1.0, " mm") if link.kind == "linear" else (DEG, "°")
            ends = [f"{round(v / unit) + 0.0:.0f}" for v in (read.min(), read.max(), low, high)]
            parts.append(f"{name} {ends[0]} to {ends[1]}{sign} (workspace {ends[2]} to {ends[3]})")
    if not parts:
        return ""
    return (
        f"The touches read only {listed(parts)}: beyond, the model extrapolates, by the shapes "
        "of errors that were assumed. A narrower workspace, or further set-ups, would tell more."
    )


def design_lines(
    placement: Placement,
    workspace: Mapping[str, tuple[float, float]],
    worst: WorstRegions | None = None,
) -> list[str]:
    """The verdict, what is left in the probed volume, what faces cost or gain, what they see."""
    own = placement.own
    others = [r for r in placement.rivals if r is not own and r.body is not None]
    line = f"in the probed volume alone it leaves {_um(own.rms)}"
    if others:
        rival = min(others, key=lambda r: r.rms)
        line += f", the best other artefact there, {rival.name}, {_um(rival.rms)}"
    told = [f(placement) for f in (identification_sentence, proof_sentence, blind_spots)]
    told += [_regions_sentence(worst)] if worst is not None else []
    return [verdict_of_design(placement, workspace), line, *filter(None, told)]


def _regions_sentence(worst: WorstRegions) -> str:
    """What the faces see of the poses at which machines are wrong again and again."""
    return (
        f"Where errors dominate, at the {worst.poses} poses of your workspace that are most often "
        f"among the worst twentieth ({100 * worst.recurrence:.0f} % of random machines each, on "
        f"average): touches on the freeform faces alone leave {_um(worst.after)} of the expected "
        f"{_um(worst.before)}; they see {100 * worst.covered:.0f} % of these poses, with a tenth "
        "of the error left at most."
    )


def proof_line(number: int, in_workspace: Proof, in_volume: Proof, fit: Fit) -> str:
    """One simulated machine: what its model does not predict, there and on the faces held back."""
    held_back = fit.test_rows
    left, noise = (rms(v[held_back]) if held_back.any() else 0.0 for v in (fit.residual, fit.run.u))
    faces = f"; on the faces held back {_um(left)} rms is left, noise {_um(noise)}" if left else ""
    return (
        f"machine {number}: in your workspace {_after(in_workspace)}; "
        f"in the probed volume {_after(in_volume)}{faces}"
    )


def _after(proof: Proof) -> str:
    return (
        f"{_um(proof.rms_before)} rms, not predicted {_um(proof.rms_after)} (stated uncertainty "
        f"{_um(proof.rms_u)}), {digits(proof.factor, 2)} times smaller"
    )


def _um(value: float) -> str:
    return f"{digits(value / UM)} µm"
