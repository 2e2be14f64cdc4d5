"""How far beside its stated pose a standard may stand: one limit per direction."""

from typing import NamedTuple

import numpy as np

from matstd.artefact.body import Meeting, contact
from matstd.probe_paths.plan import SMALLEST_GAP, TouchPlan
from matstd.twin.frames import Array, apply, fixed_xyz, inverse, pose, turn
from matstd.twin.machine import linear_directions, tip
from matstd.twin.sampling import spread_rows
from matstd.twin.units import DEG

PARTS = (1.0, 0.8, 0.6, 0.4, 0.2)
"""Parts of the clearance that are tried where a touch would be lost within it."""

_TOUCHES = 60  # of the plan, evenly: each takes 3 ms, and there are twelve directions
_HUNDREDTH = 0.01 * DEG


class Admissible(NamedTuple):
    """Largest offset of a standard in one direction, either way."""

    offset: float  # mm or rad; zero where the smallest part of the clearance is too much already
    is_clearance: bool  # the clearance limits it; otherwise a touch that would be lost


def setup_tolerance(plan: TouchPlan) -> dict[str, Admissible]:
    """Offset of the standard that the programs of a plan admit: the smaller of two limits.

    The programs keep the gap `SMALLEST_GAP` to a standard in its stated pose; with a larger offset
    the probe may hit it. A rotation moves its farthest point by ``angle * distance from the axis``,
    and is rounded down to 0.01 degrees. On the perfect twin, every sampled touch also has to meet
    its planned feature within its path.

    Returns:
        By X Y Z, and A B C about the standard's own axes; one direction at a time.
    """
    # a sample of the plan: every touch is marched in twelve directions, 3 ms each
    rows = spread_rows(len(plan), _TOUCHES)
    direction = np.zeros((len(rows), len(plan.chain.axes)))
    direction[:, [plan.chain.axis_index(a) for a in "XYZ"]] = plan.direction[rows]
    along = linear_directions(plan.chain, plan.start[rows])
    way = np.einsum("nij,nj->ni", along, direction[:, plan.chain.linear_columns])
    centre = tip(plan.chain, plan.start[rows], plan.probe.length)

    def is_met(T_artefact_standing: Array) -> bool:
        T_standing_table = inverse(plan.setup.T_table_artefact @ T_artefact_standing)
        met = contact(
            plan.standard,
            apply(T_standing_table, centre),
            turn(T_standing_table, way),
            plan.probe.radius,
            np.full(len(rows), plan.distance),
        )
        good = (met.meeting == Meeting.SURFACE) & (met.feature == plan.feature[rows])
        return bool(good.all())

    def moved(i: int, size: float) -> Array:
        vector = size * np.eye(3)[i % 3]
        return pose(t=vector) if i < 3 else pose(fixed_xyz(vector))

    corner = np.array([*plan.standard.base.half_size, plan.standard.blank_height])

    def admissible(i: int) -> Admissible:
        clearance = SMALLEST_GAP
        if i >= 3:
            lever = np.linalg.norm(np.delete(corner, i % 3))
            clearance = np.floor(SMALLEST_GAP / lever / _HUNDREDTH) * _HUNDREDTH
        for part in PARTS:
            if is_met(moved(i, part * clearance)) and is_met(moved(i, -part * clearance)):
                return Admissible(part * clearance, part == PARTS[0])
        return Admissible(0.0, False)

    return {letter: admissible(i) for i, letter in enumerate("XYZABC")}
