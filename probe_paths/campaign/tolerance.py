"""Largest misplacement of a standard at which no touch is lost."""

from collections.abc import Callable, Sequence

import numpy as np

from matstd.artefact.body import Meeting, contact
from matstd.probe_paths.plan import TouchPlan
from matstd.twin.frames import Array, apply, fixed_xyz, inverse, pose, turn
from matstd.twin.machine import linear_directions, tip
from matstd.twin.sampling import spread_rows
from matstd.twin.units import DEG

STEPS_MM = (0.5, 1.0, 1.5, 2.0, 2.5)
"""Displacements that are tried, mm; a touch looks 3 mm beyond the surface."""

STEPS_DEG = (0.1, 0.25, 0.5, 1.0)  # rotations that are tried, degrees
_TOUCHES = 60  # of the plan, evenly: each takes 3 ms, and there are twelve directions


def setup_tolerance(plan: TouchPlan) -> dict[str, float]:
    """Largest displacement, either way, by which no touch of a plan is lost.

    The standard is displaced on the perfect twin, and every sampled touch has to meet its
    planned feature within its path.

    Returns:
        By X Y Z, mm, and A B C, degrees, about the standard's own axes; zero where the smallest
        step is too much already.
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
        return pose(t=vector) if i < 3 else pose(fixed_xyz(vector * DEG))

    def largest(i: int) -> float:
        steps = STEPS_MM if i < 3 else STEPS_DEG
        return _largest(steps, lambda size: is_met(moved(i, size)))

    return {letter: largest(i) for i, letter in enumerate("XYZABC")}


def _largest(steps: Sequence[float], is_good: Callable[[float], bool]) -> float:
    """Largest step that is good in both directions, by bisection."""
    low, high = 0, len(steps)
    while low < high:
        middle = (low + high + 1) // 2
        good = is_good(steps[middle - 1]) and is_good(-steps[middle - 1])
        low, high = (middle, high) if good else (low, middle - 1)
    return steps[low - 1] if low else 0.0
