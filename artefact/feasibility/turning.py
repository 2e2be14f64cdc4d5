"""Bodies on other axes, which the standard and its table pass while rotary axes turn.

A clamp on the cradle of a trunnion stands still while the table turns the standard past it.
Programs turn through every reading between two table poses, so the whole workspace is looked at.
"""

from collections.abc import Iterator, Mapping
from dataclasses import dataclass

import numpy as np

from matstd.artefact.brief import Brief
from matstd.artefact.reach import Body, still_frames, table_face
from matstd.artefact.seat import CONTACT_DEPTH, base_corners, common_part, overlap
from matstd.twin.frames import Array, apply, inverse
from matstd.twin.record import Setup
from matstd.twin.units import DEG

TURN_STEP = 10.0 * DEG
"""Distance of the readings that are looked at: at 200 mm from the axis 17 mm, less than a clamp."""

TURN_PLACES = 5  # readings of a linear axis between a body and the table that are looked at
ROUGH, FINE = 24, 256  # sides of the polygon round a disc: first, and where it decides


@dataclass(frozen=True, eq=False)
class Meeting:
    """The pose at which a body reaches deepest into what turns."""

    number: int  # of the body in the file
    body: Body
    met: str  # what it meets: `the base of the standard` or `the table`
    pose: dict[str, float]  # readings of the axes between body and table, mm and rad, by name
    depth: float  # shortest way by which it would leave the other, mm


def between(brief: Brief, body: Body) -> tuple[str, ...]:
    """Axes between a body and the table, whose readings move one past the other."""
    inner = brief.chain.carrying_axes
    return inner[: inner.index(body.on)] if body.on in inner else ()


def meetings(brief: Brief, setup: Setup) -> Iterator[Meeting]:
    """Bodies that the base of the standard or the table meets at a pose of the workspace."""
    base = base_corners(brief.blank.base, setup.T_table_artefact)
    for number, body in enumerate(brief.bodies):
        if body.setup not in {"", setup.name} or not between(brief, body):
            continue
        q = _poses(brief, body)
        frames = seen_from_face(brief, setup, body, q)
        discs = [brief.table.corners(sides) for sides in (ROUGH, FINE)]
        for met, rough, fine in (
            ("the base of the standard", base, base),
            ("the table", discs[0], discs[1]),
        ):
            depths = np.array([_depth(body, T, rough, ROUGH) for T in frames])
            worst = int(np.argmax(depths))
            if depths[worst] > CONTACT_DEPTH:
                depth = _depth(body, frames[worst], fine, FINE)
                if depth > CONTACT_DEPTH:
                    names = between(brief, body)
                    at = {name: float(q[worst, brief.chain.axis_index(name)]) for name in names}
                    yield Meeting(number=number, body=body, met=met, pose=at, depth=depth)


def seen_from_face(brief: Brief, setup: Setup, body: Body, q: Array) -> Array:
    """Poses (N, 4, 4) that take a body to where the table, turned at q (N, A), sees it."""
    T_table_face = table_face(setup.T_table_artefact)
    T_still_table = still_frames([body.on], brief.chain, q)[body.on]
    return inverse(T_table_face) @ inverse(T_still_table) @ T_table_face


def _poses(brief: Brief, body: Body) -> Array:
    """Readings of a grid over the workspace of the axes between a body and the table, (N, A)."""
    chain, steps = brief.chain, []
    for name in between(brief, body):
        low, high = brief.ranges[name]
        is_rotary = chain.link(name).kind == "rotary"
        count = int(np.ceil((high - low) / TURN_STEP)) + 1 if is_rotary else TURN_PLACES
        steps.append(np.linspace(low, high, count if high > low else 1))
    q = np.zeros((int(np.prod([len(s) for s in steps])), len(chain.axes)))
    for name, values in zip(between(brief, body), np.meshgrid(*steps), strict=True):
        q[:, chain.axis_index(name)] = values.ravel()
    return q


def _depth(body: Body, T_face_still: Array, other: Array, sides: int) -> float:
    """Depth of a turned body inside the hull of some corners, mm."""
    if body.mesh is not None:
        corners = apply(T_face_still, body.mesh[0])
        if _apart(corners, other):
            return 0.0
        common = common_part(corners, body.mesh[1], other)
        return float(np.ptp(common, axis=0).min()) if len(common) else 0.0
    turned = (apply(T_face_still, solid.corners(sides)) for solid in body.solids)
    return max(0.0 if _apart(c, other) else overlap(c, other).depth for c in turned)


def _apart(corners: Array, other: Array) -> bool:
    """Whether the boxes round two bodies do not meet."""
    low, high = corners.min(axis=0), corners.max(axis=0)
    return bool(np.any(low >= other.max(axis=0)) or np.any(high <= other.min(axis=0)))


def pose_words(brief: Brief, readings: Mapping[str, float]) -> str:
    """Readings of axes in the units of the file: `B = -90, C = 45 degrees`."""
    is_rotary = [brief.chain.link(name).kind == "rotary" for name in readings]
    shown = [
        f"{name} = {value / DEG if turns else value:.4g}"
        for (name, value), turns in zip(readings.items(), is_rotary, strict=True)
    ]
    return ", ".join(shown) + (" degrees" if all(is_rotary) else "")
