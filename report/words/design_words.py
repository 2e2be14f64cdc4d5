"""What is said of a design: what the standard leaves unknown of the machine, and what others leave.

The user's workspace comes first, because that is where parts are made; the probed volume, the box
that the ball reaches on the standard, comes second and is named as such.
"""

import numpy as np

from artefact.compare import Rival
from artefact.place import Placement
from diagnosis.answer import Proof
from diagnosis.fit import Fit
from report.numbers import digits
from report.words.artefact_words import identification_sentence, proof_sentence
from twin.units import UM

EQUAL = 1.05
"""Ratio of two predicted errors up to which they are called equal: no user would notice it."""


def best_rival(placement: Placement) -> Rival | None:
    """The other artefact that somebody could build and that leaves least in the workspace."""
    others = [r for r in placement.rivals if r is not placement.own and r.body is not None]
    return min(others, key=lambda r: r.rms_user, default=None)


def verdict_of_design(placement: Placement) -> str:
    """What the standard leaves in the user's workspace, and how the best rival compares."""
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


def design_lines(placement: Placement) -> list[str]:
    """The verdict, what is left in the probed volume, and what faces cost or gain over spheres."""
    own = placement.own
    others = [r for r in placement.rivals if r is not own and r.body is not None]
    line = f"in the probed volume alone it leaves {_um(own.rms)}"
    if others:
        rival = min(others, key=lambda r: r.rms)
        line += f", the best other artefact there, {rival.name}, {_um(rival.rms)}"
    told = [identification_sentence(placement), proof_sentence(placement)]
    return [verdict_of_design(placement), line, *filter(None, told)]


def proof_line(number: int, in_workspace: Proof, in_volume: Proof, fit: Fit) -> str:
    """One simulated machine: what its model does not predict, there and on the faces held back."""
    held_back = fit.test_rows
    left, noise = (
        float(np.sqrt(np.mean(v[held_back] ** 2))) if held_back.any() else 0.0
        for v in (fit.residual, fit.run.u)
    )
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
