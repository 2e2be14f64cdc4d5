"""Assignment of touches to several probes and clampings of one standard.

The first probe in the first clamping, for which the standard was designed, makes every touch that
it can. The next probe makes the others, and repeats some touches on balls because the offset of its
stylus from the first is not known to a micrometre. A further clamping gets the same places on the
standard, at table poses of the first at which they can be touched there.
"""

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from matstd.artefact.body import Standard
from matstd.artefact.reach import Clamping, ProbeReach, Requests
from matstd.probe_paths.plan import PlanOptions, Probe, Refusal, TouchPlan, plan_touches
from matstd.twin.errors import NotReachable
from matstd.twin.frames import IntArray
from matstd.twin.machine import Chain
from matstd.twin.record import Setup

_POSES_TRIED = 6
"""Table poses at which a place of a further clamping is looked for, the best inclined first."""

_LINKING_TOUCHES = 8
"""Touches on balls that a further probe repeats, at every pose that it visits or else at others:
twice the four numbers of a stylus."""


def plan_campaign(
    standard: Standard,
    chain: Chain,
    probes: Sequence[Probe],
    clampings: Sequence[Clamping],
    requests: Requests,
    options: PlanOptions,
) -> list[tuple[int, TouchPlan]]:
    """Plans of all probes (numbered from 0) in all clampings, in the order of execution.

    Refusals stand with the first probe of a clamping, where no probe makes the touch; places that a
    further clamping does not reach are not counted as refused.

    Args:
        probes: The one that the standard was designed for, then those for the remaining touches.
        clampings: The one that it was designed for, then others.
        requests: Wanted touches, at table poses of the first clamping.

    Raises:
        NotReachable: More requests of the first clamping refused by all probes than tolerated; a
            further clamping in which nothing can be touched.
    """
    out: list[tuple[int, TouchPlan]] = []
    for number, clamping in enumerate(clampings):
        here = replace(options, workshop=clamping.workshop)
        wanted, tolerated = requests, options.tolerated
        if number:
            wanted = _in_other_clamping(standard, chain, probes, clamping, requests)
            tolerated = len(wanted)
        out += _plans(standard, chain, probes, clamping.setup, wanted, here, tolerated)
    return out


def _plans(
    standard: Standard,
    chain: Chain,
    probes: Sequence[Probe],
    setup: Setup,
    wanted: Requests,
    options: PlanOptions,
    tolerated: int,
) -> list[tuple[int, TouchPlan]]:
    """Plans in one clamping, each with the number of its probe."""
    left, out = np.arange(len(wanted)), list[tuple[int, TouchPlan]]()
    most = tolerated if len(probes) == 1 else len(wanted)
    against: dict[int, Refusal] = {}
    for number, probe in enumerate(probes):
        if not len(left):
            break
        here, rows = replace(options, tolerated=most), left
        if number:
            rows = np.concatenate([left, _repeated_ball_touches(standard, wanted, left)])
        try:
            plan = plan_touches(standard, chain, probe, setup, wanted[rows], here)
        except NotReachable:
            if not out:  # the first is the one that everything was designed for
                raise
            continue  # the reasons of the first probe stand
        refused = [r for r in plan.refused if 0 <= r.request < len(left)]
        anchors = tuple(r for r in plan.refused if r.request < 0)
        among_all = np.where(plan.request >= 0, rows[np.maximum(plan.request, 0)], plan.request)
        plan = replace(plan, request=among_all, refused=anchors)
        left = left[[r.request for r in refused]] if refused else left[:0]
        for row, refusal in zip(left.tolist(), refused, strict=True):
            against.setdefault(row, replace(refusal, request=row))
        out.append((number, plan))
    lost = tuple(against[row] for row in left.tolist())
    if len(lost) > tolerated:
        raise NotReachable(
            f"{len(lost)} of {len(wanted)} touches cannot be made by any of {len(probes)} probes, "
            f"{tolerated} tolerated; the first, by the first probe: {lost[0]}",
            refused=list(lost),
        )
    number, first = out[0]
    return [(number, replace(first, refused=(*lost, *first.refused))), *out[1:]]


def _repeated_ball_touches(standard: Standard, wanted: Requests, left: IntArray) -> IntArray:
    """Touches on balls to repeat: at the poses of the remaining touches, or elsewhere."""
    is_ball = np.isin(wanted.feature, [sphere.name for sphere in standard.spheres])
    is_ball[left] = False
    pose = wanted.pose
    lots = [
        np.flatnonzero(is_ball & (pose == one))[:_LINKING_TOUCHES] for one in np.unique(pose[left])
    ]
    here = np.concatenate(lots)
    elsewhere = np.setdiff1d(np.flatnonzero(is_ball), here)
    return np.concatenate([here, elsewhere[: max(_LINKING_TOUCHES - len(here), 0)]])


def _in_other_clamping(
    standard: Standard,
    chain: Chain,
    probes: Sequence[Probe],
    clamping: Clamping,
    requests: Requests,
) -> Requests:
    """The same places in another clamping, each at a table pose at which it can be touched there.

    That is its own pose, or else the one of all occurring poses at which the probe is inclined
    least. Places that no probe reaches at any pose are left out.

    Raises:
        NotReachable: Nothing is left.
    """
    poses = np.unique(requests.rotary, axis=0)
    rotary, found = requests.rotary.copy(), np.zeros(len(requests), dtype=bool)
    for probe in probes:
        place = clamping.setup, probe.shape, probe.length
        reach = ProbeReach(chain, *place, workshop=clamping.workshop)
        lean = reach.everywhere(requests.point, requests.normal, poses)[1]  # (N, K)
        best = np.argsort(lean, axis=1, kind="stable")
        # attempt -1 is the pose of the first clamping
        for attempt in range(-1, min(_POSES_TRIED, len(poses))):
            rows = np.flatnonzero(~found)
            if attempt >= 0:
                rows = rows[lean[rows, best[rows, attempt]] < reach.steepest]
                rotary[rows] = poses[best[rows, attempt]]
            tried = replace(requests[rows], rotary=rotary[rows])
            rows = rows[reach.is_reachable(tried)]
            tried = replace(requests[rows], rotary=rotary[rows])
            found[rows[reach.is_clear(standard, tried)]] = True
    if not found.any():
        raise NotReachable(
            f"set-up {clamping.setup.name}: none of {len(requests)} touches can be made there"
        )
    return replace(requests, rotary=rotary)[found]
