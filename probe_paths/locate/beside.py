"""Programs beside those of a plan: a dry run, a search for the standard, one ball, one touch."""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from itertools import product
from pathlib import Path

import numpy as np

from matstd.artefact.body import DatumSphere
from matstd.artefact.reach import Requests
from matstd.probe_paths.emit import (
    Feeds,
    ProgramSet,
    make_ball,
    make_dry_run,
    make_first,
    make_search,
)
from matstd.probe_paths.language import Dialect
from matstd.probe_paths.locate.find import SPREADS, Spread
from matstd.probe_paths.locate.search_plan import plan_search
from matstd.probe_paths.plan import (
    PlanTask,
    TouchPlan,
    home_readings,
    plan_touches,
    ring_normals,
    ring_requests,
)
from matstd.twin.errors import NotReachable
from matstd.twin.frames import Array
from matstd.twin.units import DEG

_TILTS = (75.0 * DEG, 60.0 * DEG, 45.0 * DEG)
"""Angles of the ring to the tool axis, rad, steepest first: 75 degrees separate radius and height
five times as well as 45, and leave a stem the room of its own thickness."""

_RING = 6

_CERTAIN_COLLISION = -3.0
"""Room below which a collision is certain, mm: the quick check underestimates room by less."""


def plan_ball(plan: TouchPlan, is_beside: bool = False) -> TouchPlan:
    """Plan of a pole and a ring of six touches on a ball, all at one table pose.

    The ball is the first of the standard, and the pose the first, that let the probe have all of
    them: rotary axes at home, then the poses of the plan.

    Args:
        is_beside: The ball is that of the workshop, on the table beside the standard.

    Raises:
        NotReachable: No ball can be touched all round at any pose.
    """
    home = home_readings(plan.chain)
    poses = np.unique([visit.rotary for visit in plan.visits], axis=0)
    steps = np.abs(poses - home).max(axis=1, initial=0.0)
    poses = np.concatenate([home[None], poses[np.argsort(steps, kind="stable")]])
    standard, general = plan.standard, plan.options
    balls = standard.spheres
    if is_beside:
        ball, room = general.workshop.ball, replace(general.workshop, ball=None)
        assert ball is not None
        standard = ball.beside(standard, plan.setup.T_table_artefact)
        balls, general = standard.spheres[-1:], replace(general, workshop=room, ball=ball)
    why = "the probe would run into something" if balls else "it has no ball"
    task = PlanTask(
        chain=plan.chain, probe=plan.probe, standard=standard, setup=plan.setup, options=general
    )
    for sphere, wanted in _without_deep_collisions(task, poses, balls):
        # the first touch of every visit is that of an anchor: on the same ball
        options = replace(general, anchor=sphere.name, tolerated=0, shortest_visit=2 * _RING)
        try:
            made = plan_touches(standard, plan.chain, plan.probe, plan.setup, wanted, options)
        except NotReachable as error:
            why = str(error)
            continue
        if set(made.feature.tolist()) == {sphere.name}:
            return made
    raise NotReachable(f"no ball of {plan.standard.name} can be touched all round; the last: {why}")


def _without_deep_collisions(
    task: PlanTask, poses: Array, balls: Sequence[DatumSphere]
) -> Iterator[tuple[DatumSphere, Requests]]:
    """Rings that may be touched, pose by pose: exact gaps take half a second a ring."""
    reach = task.reach(_CERTAIN_COLLISION)
    azimuth = np.arange(_RING) * 2.0 * np.pi / _RING
    for tilt, rotary in product(_TILTS, poses if balls else []):
        # one static check for the rings of all balls
        along = np.concatenate([[[0.0, 0.0, 1.0]], ring_normals(tilt, azimuth)])
        every = ring_requests(task.chain, task.setup, balls, rotary, along)
        good = np.asarray(reach.is_reachable(every))
        good[good] = reach.is_clear(task.standard, every[good])
        for k in np.flatnonzero(good.reshape(len(balls), -1).all(axis=1)).tolist():
            yield balls[k], every[k * len(along) + np.arange(len(along))]


RAISED = 100.0  # height by which a dry run is raised, mm


@dataclass(frozen=True)
class Companions:
    """Programs that go with those of a plan."""

    dry_run: ProgramSet  # where the programs go, higher, without a touch
    raised: float  # by how much, mm
    spread: Spread  # within which a search finds the standard
    search: ProgramSet | None = None  # for the standard; None where there can be none
    no_search: str = ""
    # touches on one ball, before the programs and after them; None where there can be none
    ball: ProgramSet | None = None
    no_ball: str = ""
    # one touch that a control is tried with; None where there can be none, or none is needed
    first: ProgramSet | None = None
    no_first: str = ""

    def write(self, folder: Path) -> None:
        """Write programs and masks into a folder."""
        for programs in (self.dry_run, self.search, self.ball, self.first):
            if programs is not None:
                programs.write(folder)


def companions(
    plan: TouchPlan, dialect: Dialect, feeds: Feeds, raised: float, is_further: bool
) -> Companions:
    """Dry run, search within the widest of `SPREADS` that allows one, ball, commissioning program.

    Args:
        is_further: Whether another probe has already searched and tried the control.
    """
    dry_run = make_dry_run(plan, raised, dialect, feeds)
    made = Companions(dry_run=dry_run, raised=raised, spread=SPREADS[-1])
    is_beside = plan.options.workshop.ball is not None
    try:
        made = replace(made, ball=make_ball(plan_ball(plan, is_beside), dialect, feeds))
    except NotReachable as error:
        made = replace(made, no_ball=str(error))
    if dialect.language == "klartext" and not is_further:
        try:
            made = replace(made, first=make_first(plan_ball(plan), dialect, feeds))
        except NotReachable as error:
            made = replace(made, no_first=str(error))
    if is_further:
        return replace(made, no_search="the first probe of this set-up has found it")
    # the widest spread comes first, a narrower one where it allows no search
    for chosen in SPREADS:
        place = plan.standard, plan.chain, plan.probe, plan.setup
        try:
            search = plan_search(*place, chosen, plan.options.workshop, plan.options.retract)
        except NotReachable as error:
            made = replace(made, spread=chosen, no_search=str(error))
            continue
        programs = make_search(search, (chosen.distance, chosen.angle), dialect, feeds)
        return replace(made, search=programs, spread=chosen, no_search="")
    return made
