"""Touches as moves: in, beyond where the surface is expected, and up again when nothing was met."""

from enum import StrEnum

import numpy as np

from matstd.probe_paths.plan.clearance import SMALLEST_GAP, ToolClearance
from matstd.twin.frames import Array
from matstd.twin.record import Labels


class Stage(StrEnum):
    """Part of a touch in which the tool may come too near to something."""

    WAY_IN = "on its way in"
    TOUCH = "at the touch"
    OVER_TRAVEL = "where it goes on if the surface is not met"
    RETRACT = "on its way up after a miss"

    def least_gap(self, radius: float) -> float:
        """Gap that a ball of a radius needs, mm: beside what it touches its stylus has a third."""
        return min(SMALLEST_GAP, radius / 3.0) if self is Stage.TOUCH else SMALLEST_GAP


def stroke_gaps(
    clearance: ToolClearance,
    start: Array,
    direction: Array,
    back: Array,
    distance: Array,
    feature: Labels,
    enough: float,
) -> dict[Stage, tuple[Array, Labels]]:
    """Smallest gaps in the parts of N touches, with what is nearest.

    To the expected contact the tool above its ball keeps clear of everything, and the ball of all
    but the touched feature. Beyond it, and on the way up after a miss, both keep clear of all but
    the feature and the core, from which the columns of the faces rise.

    Args:
        start: Readings at the start, (N, A).
        direction: Direction of the motion in readings, unit vectors, (N, A).
        back: Distance to the expected contact, (N,), mm.
        distance: Longest travel, (N,), mm.
        feature: Feature that is touched, (N,).
        enough: A gap that is larger need not be known better than that, mm.
    """
    bodies = clearance.bodies
    own = np.zeros((len(start), len(bodies.name)), dtype=bool)
    for name in dict.fromkeys(feature.tolist()):
        own[np.ix_(np.flatnonzero(feature == name), bodies.rows_of(name))] = True
    # beyond the contact the core is spared, as columns come out of it
    core = np.broadcast_to(bodies.name == "CORE", own.shape)
    contact = start + back[:, None] * direction
    end = start + distance[:, None] * direction
    above = end.copy()
    z = clearance.chain.axis_index("Z")
    above[:, z] = np.maximum(end[:, z], clearance.chain.link("Z").range[1])
    tool = clearance.swept_gap(start, contact, with_ball=False, enough=enough)
    ball = clearance.swept_gap(start, contact, with_tool=False, spared=own & ~core, enough=enough)
    beyond = clearance.swept_gap(start, end, spared=own | core, enough=enough)
    up = clearance.swept_gap(end, above, spared=own | core, enough=enough)
    return {Stage.TOUCH: tool, Stage.WAY_IN: ball, Stage.OVER_TRAVEL: beyond, Stage.RETRACT: up}
