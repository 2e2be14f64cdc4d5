"""The machine of a serial arm as a run has it: lines of all joints in one gauge, to put to use.

The lines of an arm's joints are known only together: one that is copied without the others is a
displaced tracker or the zero of a neighbour. So all location errors become the places and
directions of all lines at once, fitted by themselves: beside errors of joints and effects, which a
machine file cannot hold, a line takes a share that makes the arm worse without them. The zero of a
joint, about its own line, turns everything that follows it; where the reflector sits after that is
found anew when the run is imported.
"""

from dataclasses import dataclass, replace

import numpy as np

from matstd.diagnosis.fit import Fit, fit_run
from matstd.diagnosis.geometry.quantities import geometric_effects
from matstd.twin.frames import Array, apply, rotation
from matstd.twin.machine import Chain
from matstd.twin.model import Model, traits


@dataclass(frozen=True, eq=False)
class FoundArm:
    """An arm as a run has it."""

    chain: Chain  # with points and directions of all joints
    before: float  # error of the run with nothing but the set-up in the model, mm
    after: float  # the same with this machine in place of the stated one, to first order, mm


def found_arm(fit: Fit) -> FoundArm | None:
    """The arm by the rows of a fit; None where it is none, or where lines make nothing better."""
    chain = fit.model.chain
    lines = tuple(e for _, e in geometric_effects(fit) if traits(e).ordinary_constant)
    if not chain.joints or not lines:
        return None
    fit = fit_run(fit.run, Model(chain, lines), gross=fit.gross)
    sizes = {
        (symbol.link, symbol.component): (start, float(fit.theta[start]))
        for start, e in geometric_effects(fit)
        if (symbol := traits(e).ordinary_constant)
    }
    links, after = [], np.eye(4)  # what the zeros of the joints before do to everything behind
    for link in chain.links:
        if link.is_joint:
            e = np.array([sizes.get((link.name, k), (0, 0.0))[1] for k in range(6)])
            zero, e[link.own_component] = e[link.own_component], 0.0
            e = link.in_machine(e)
            point = apply(after, link.point + e[:3])
            direction = after[:3, :3] @ rotation(e[3:]) @ link.direction
            links.append(replace(link, point=point, direction=direction))
            after = _about(point, direction, zero) @ after
        else:
            links.append(link)
    linear = np.array([start for start, _ in sizes.values()])
    moved = fit.model.columns(fit.run.touches)[:, linear] @ fit.theta[linear]
    alone = Model(chain, ())
    found = fit_run(replace(fit.run, deviation=fit.run.deviation - moved), alone, gross=fit.gross)
    before = fit_run(fit.run, alone, gross=fit.gross)
    if found.rms >= before.rms:
        return None
    return FoundArm(replace(chain, links=tuple(links)), before.rms, found.rms)


def _about(point: Array, direction: Array, angle: float) -> Array:
    """Turn about a line, (4, 4)."""
    out = np.eye(4)
    out[:3, :3] = rotation(angle * direction)
    out[:3, 3] = point - out[:3, :3] @ point
    return out
