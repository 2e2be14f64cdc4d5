"""Sag of the joints of a serial arm under the weight of the links that follow.

The gears of a joint give way in proportion to the torque of gravity on it. Geometry gives all of it
but the weights. A weight on the line between two joints acts like its shares at both ends, so
weights at the joints that follow and at the flange represent all straight links.
"""

from collections.abc import Iterable, Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from itertools import pairwise
from typing import Annotated, Self

import numpy as np

from matstd.twin.fields import Argument, Refuse
from matstd.twin.frames import Array, apply, turn
from matstd.twin.machine import Chain, Link, table_to_tool
from matstd.twin.model import Declared, Kind, Parameter, Term, Title, Where
from matstd.twin.record import Touches
from matstd.twin.units import URAD

SAME_POINT = 1e-6  # points closer than this (mm) with every axis at zero are equal
FLANGE = "flange"  # name of the gauge point among the places of weights
DOWN = np.array([0.0, 0.0, -1.0])
"""Direction of weights in the machine frame, whose Z stands upright (ISO 841)."""


def _joint(text: str, chain: Chain, refuse: Refuse) -> str:
    if text not in chain.tool_rotary_axes:
        known = ", ".join(chain.tool_rotary_axes) or "none on this machine"
        raise refuse(f"a rotary axis that carries the tool: {known}")
    return text


@dataclass(frozen=True)
class JointSag(Declared):
    """Rotation of a joint that gives way under the weights behind it.

    ``E = sum_k c W_k d . ((p_k - p) x down)`` about the joint's line through p along d, for weights
    W_k at points p_k; c is the compliance of the joint. One parameter, c W_k, for every point: a
    positive one, rad a millimetre of lever, turns the arm down.

    Reference:
        Static torque of gravity of an open chain; joint compliance is what remains of a calibrated
        arm: Judd and Knasinski, IEEE Trans. Robotics and Automation 6 (1990) 20.
    """

    joint: Annotated[str, Argument("axis", _joint)]
    # names of the joints at whose points weights are taken to be, and `flange` for the gauge point,
    # where a payload hangs
    places: tuple[str, ...] = ()

    kind = "joint-sag"
    is_curve = True
    is_reported_whole = True

    @cached_property
    def title(self) -> Title:
        return Title(f"sag of joint {self.joint} under the weight of the arm", self.joint)

    def on(self, chain: Chain, refuse: Refuse) -> Self:
        """With the places of the weights."""
        found = replace(self, places=weights_behind(chain, self.joint))
        if not found.places:
            raise refuse("a joint behind which the arm has a length")
        return found

    @cached_property
    def parameters(self) -> Sequence[Parameter]:
        # 200 N at 1 m on a joint of 200 N m/mrad: 1 mrad over 1000 mm
        return tuple(Parameter(f"weight at {p}", "rad/mm", URAD) for p in self.places)

    def terms(self, touches: Touches) -> Sequence[Term]:
        """Twists about the joint's line, whatever its direction."""
        chain = touches.chain
        link = chain.link(self.joint)
        carrier = _body_before(touches, link)
        point, line = apply(carrier, link.point), turn(carrier, link.direction)
        out = []
        for k, place in enumerate(self.places):
            after = chain.links[-1] if place == FLANGE else chain.link(place)
            lever = apply(_body_before(touches, after), after.point) - point
            torque = np.einsum("ni,ni->n", line, np.cross(lever, DOWN))
            about = Where("twist", chain.link_index(self.joint), link.own_component)
            out.append(Term(k, about, torque))
        return tuple(out)


def _body_before(touches: Touches, link: Link) -> Array:
    """Pose of the body that a link of the tool side sits on, in the machine frame, (N, 4, 4)."""
    chain = touches.chain
    before = [ln for ln in chain.links[: chain.link_index(link.name)] if not ln.carries_workpiece]
    part = replace(
        chain, links=(chain.links[0], *before, chain.links[-1]), table_origin=np.zeros(3)
    )
    return table_to_tool(part, touches.q[:, [chain.axis_index(ln.name) for ln in before]])


def weights_behind(chain: Chain, joint: str) -> tuple[str, ...]:
    """Names of the points behind a joint at which weights are taken to be, each place once.

    The point of the next joint has no lever if it lies on this joint's line; two at one place are
    one.
    """
    joints = chain.tool_rotary_axes
    own = chain.link(joint)
    ends = [*(chain.link(j) for j in joints[joints.index(joint) :]), chain.links[-1]]
    places = []
    for before, after in pairwise(ends):
        lever = after.point - before.point
        lever = np.cross(own.direction, lever) if before is own else lever
        if np.linalg.norm(lever) > SAME_POINT:
            places.append(FLANGE if after.kind == "fixed" else after.name)
    return tuple(places)


def propose(touches: Touches) -> Iterable[JointSag]:
    """Every joint of an open chain."""
    for joint in touches.chain.joints:
        places = weights_behind(touches.chain, joint)
        if places:
            yield JointSag(joint, places)


KIND = Kind.of(
    JointSag,
    title="sag of the joints of a serial arm",
    synonyms="joint compliance, gear compliance, joint stiffness, link weight, payload, robot, "
    "gravity torque, elastic deflection of an arm",
    formula="E = sum c W_k d.((p_k - p) x down), p_k the points of the joints that follow",
    units="c W_k: µrad/mm",
    typical="0.1 to 2 µrad/mm: 0.1 to 2 mrad of a shoulder with the arm stretched out",
    source="static torque of gravity of an open chain over the stiffness of a joint",
    propose=propose,
)
