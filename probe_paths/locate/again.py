"""The touches of programs, planned again for where the standard stands."""

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from matstd.artefact.body import Standard
from matstd.artefact.reach import DatumBall, Requests, Workshop
from matstd.probe_paths.control import ReadProgram
from matstd.probe_paths.linuxcnc import shortened
from matstd.probe_paths.locate.planned_visit import PlannedVisit
from matstd.probe_paths.plan import TouchPlan, plan_touches
from matstd.twin.machine import Chain
from matstd.twin.record import Setup

DROPPED = 0.1  # share of the touches that may be refused at another place, each with its reason


def planned_again(
    programs: Sequence[ReadProgram],
    standard: Standard,
    chain: Chain,
    setup: Setup,
    ball: DatumBall | None = None,
    visit: PlannedVisit | None = None,
) -> TouchPlan:
    """Plan of the touches that programs make, for another place of the standard.

    Poses, places on the standard, probe and workshop are those of the programs; anchor touches,
    heights, ways and order are planned again.

    Args:
        programs: Programs of one set-up, as read.
        ball: On the table, by which the probe is watched; programs state it as cylinders.
        visit: Touches that are made in the place of theirs, in its order.

    Raises:
        NotReachable: More touches cannot be made there than may be dropped.
    """
    old = shortened(programs, standard, chain)
    wanted = _touches_of(old, standard) if visit is None else visit.requests
    options = replace(old.options, tolerated=int(DROPPED * len(wanted)))
    if ball is not None:
        room = options.workshop
        known = Workshop(room.table, (), ball)
        stated = {solid.name for solid in known.solids}
        others = tuple(solid for solid in room.bodies if solid.name not in stated)
        options = replace(options, workshop=replace(known, bodies=others))
    order = None if visit is None else visit.order
    return plan_touches(standard, chain, old.probe, setup, wanted, options, order)


def _touches_of(old: TouchPlan, standard: Standard) -> Requests:
    """What a plan touches besides its anchors."""
    # a ball at the beginning of a visit is an anchor, which the new plan adds itself
    first = np.concatenate([[True], np.diff(old.visit) > 0])
    balls = [sphere.name for sphere in standard.spheres]
    rows = np.flatnonzero(~(first & np.isin(old.feature, balls)))
    return Requests(
        old.feature[rows],
        old.point[rows],
        old.normal[rows],
        np.array([visit.rotary for visit in old.visits])[old.visit[rows]],
    )
