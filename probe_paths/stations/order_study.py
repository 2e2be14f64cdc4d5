"""Time on the machine and separability of effects for different orders of the same touches.

The same touches are put into quicker orders. For each, programs are made and read back, so that
times and sides of approach are those of the programs' text; then a drift of the set-up and a
reversal of each rotary axis, both of unknown size, are fitted together with every error of the
machine. Their standard deviations measure how well the order separates them from geometry.
"""

from dataclasses import dataclass, replace
from enum import Enum

import numpy as np

from matstd.artefact.body import Standard
from matstd.artefact.reach import Requests
from matstd.probe_paths.control import Clock, step_times
from matstd.probe_paths.emit import Feeds, make_programs
from matstd.probe_paths.plan import (
    PlanOptions,
    Probe,
    TouchPlan,
    Visit,
    home_readings,
    plan_touches,
    short_order,
)
from matstd.twin.errors import NotReachable
from matstd.twin.frames import Array
from matstd.twin.library import parse_effect
from matstd.twin.machine import Chain
from matstd.twin.model import Effect, Model, columns
from matstd.twin.record import Setup, Touches, at_poses
from matstd.twin.rows import picked

_PRIOR_FACTOR = 1e3
"""Prior of the sought effects in units of their typical size: almost uninformative."""


class Ordering(Enum):
    """How the same touches can be put in order."""

    AS_PLANNED = "as planned"
    WITHOUT_ANCHORS = "without anchor touches"
    ONCE = "every pose once"
    SHORTEST = "shortest way"


@dataclass(frozen=True)
class Order:
    """One order of the same touches."""

    ordering: Ordering
    touches: int  # number, anchor touches included
    duration: float  # duration of all programs, s
    drift: float  # standard deviation of the rate of a drift, its worst direction, mm/h
    # standard deviation of the reversal of every rotary axis, in chain order, rad
    reversal: tuple[float, ...]


def orders(plan: TouchPlan, model: Model, noise: float) -> tuple[Order, ...]:
    """The plan's own order first, then the same touches in ever quicker ones; noise in mm."""
    bare = picked(plan, np.flatnonzero(plan.request >= 0))
    once = _each_pose_once(bare)
    tried = (
        (Ordering.AS_PLANNED, plan),
        (Ordering.WITHOUT_ANCHORS, bare),
        (Ordering.ONCE, once),
        (Ordering.SHORTEST, _shortest(once)),
    )
    return tuple(_evaluated_order(ordering, one, model, noise) for ordering, one in tried)


def _evaluated_order(ordering: Ordering, plan: TouchPlan, model: Model, noise: float) -> Order:
    touches, duration = _timed(plan)
    rotary = plan.chain.rotary_axes
    sought: list[Effect] = [parse_effect("drift", plan.chain)]
    sought += [parse_effect(f"backlash({axis})", plan.chain) for axis in rotary]
    size = np.array([p.sd for effect in sought for p in effect.parameters]) * _PRIOR_FACTOR
    sd = size * _sd_beside(
        columns(sought, touches) * size / noise, model.columns(touches) * model.prior_sd / noise
    )
    drift = float(sd[:3].max())
    reversal = tuple(float(value) for value in sd[3:])
    return Order(
        ordering=ordering, touches=len(plan), duration=duration, drift=drift, reversal=reversal
    )


def _sd_beside(C: Array, W: Array) -> Array:
    """Standard deviations of C's parameters with W's unknown too, all with unit priors, (Q,)."""
    known = np.eye(W.shape[1]) + W.T @ W
    left = np.eye(C.shape[1]) + C.T @ C - C.T @ W @ np.linalg.solve(known, W.T @ C)
    return np.sqrt(np.diag(np.linalg.solve(left, np.eye(len(left)))))


def _timed(plan: TouchPlan) -> tuple[Touches, float]:
    """Touches with times and sides of approach from the programs' text, and the duration, s."""
    # all in one program: an order shall not be judged by where its files begin
    programs = make_programs(plan, feeds=Feeds(touches_per_file=len(plan)))
    read = programs.programs[0].read
    travel = np.full(len(read.touches), plan.options.standoff)
    clock = step_times(plan.chain, read.steps, Clock(), travel)
    time = clock[read.touch_rows]
    side = np.array([touch.side for touch in read.touches])
    return _record(plan, time, side), float(clock[-1])


def _record(plan: TouchPlan, time: Array, approach: Array) -> Touches:
    return replace(
        at_poses(plan.chain, plan.contact, plan.probe.length),
        radius=np.full(len(plan), plan.probe.radius),
        point=plan.point,
        normal=plan.normal,
        setups=(plan.setup,),
        time=time,
        approach=approach,
        feature=plan.feature,
        pose=np.array([visit.pose for visit in plan.visits])[plan.visit],
    )


def _shortest(plan: TouchPlan) -> TouchPlan:
    """Visits in a short order from home and back, every pose approached from the one before."""
    way = short_order(np.array([v.rotary for v in plan.visits]), home_readings(plan.chain))
    here, last = home_readings(plan.chain), np.zeros(len(plan.chain.rotary_axes))
    visits = []
    for stop in (plan.visits[i] for i in way):
        side = np.where(stop.rotary == here, last, np.sign(stop.rotary - here))
        # an axis that has not turned at all yet is reached as it was planned
        before = np.where(side == 0.0, stop.before, stop.rotary)
        side = np.where(side == 0.0, stop.side, side)
        visits.append(replace(stop, before=before, side=side))
        here, last = stop.rotary, side
    return _each_pose_once(plan, tuple(visits))


def _each_pose_once(plan: TouchPlan, visits: tuple[Visit, ...] = ()) -> TouchPlan:
    """Every pose visited once, in the order of some visits or that of the plan."""
    first: dict[int, Visit] = {}
    for visit in visits or plan.visits:
        first.setdefault(visit.pose, visit)
    pose = np.array([visit.pose for visit in plan.visits])[plan.visit]
    sideways = plan.frame.linear[:2]
    rows = []
    for k in first:
        mine = np.flatnonzero(pose == k)
        places = plan.start[mine][:, sideways]
        rows.append(mine[short_order(places, places[0])])
    sizes = [len(mine) for mine in rows]
    moved = picked(plan, np.concatenate(rows))
    return replace(
        moved, visits=tuple(first.values()), visit=np.repeat(np.arange(len(first)), sizes)
    )


def probing_time(
    body: Standard,
    chain: Chain,
    probe: Probe,
    setup: Setup,
    requests: Requests,
    options: PlanOptions,
) -> float:
    """Time on the machine of a plan of the same care, s; nan where no plan can be made.

    Touches that this plan refuses are counted as if they took as long as the others.
    """
    options = replace(options, tolerated=len(requests), is_swept=False)
    try:
        plan = plan_touches(body, chain, probe, setup, requests, options)
    except NotReachable:
        return float(np.nan)
    planned = int(np.sum(plan.request >= 0))
    return make_programs(plan).duration * len(requests) / planned
