"""Makes a plan: computes every touch, refuses impossible ones, puts the rest in order.

Touches are computed in readings, checked for reach, and swept with the whole tool. One that the
sweep refuses is tried from inclined directions.
"""

from dataclasses import dataclass, replace

import numpy as np

from matstd.artefact.body import Standard
from matstd.artefact.reach import Requests, joined
from matstd.artefact.tool import Probe, home_readings, solid_hull, swing_height, top_height
from matstd.probe_paths.plan.approach import Approaches
from matstd.probe_paths.plan.clearance import SMALLEST_GAP, Stage, stroke_gaps
from matstd.probe_paths.plan.frame import ProgramFrame
from matstd.probe_paths.plan.heading import rounded_setup, rounded_workshop
from matstd.probe_paths.plan.order import (
    StatedVisits,
    Visit,
    rotary_path,
    short_order,
    stated_visits,
    visits,
)
from matstd.probe_paths.plan.touch_plan import (
    GRID,
    PlanOptions,
    PlanTask,
    Refusal,
    TouchPlan,
    ring_normals,
    ring_requests,
)
from matstd.twin.errors import DesignError, NotReachable, ShapeMismatch
from matstd.twin.frames import Array, IntArray
from matstd.twin.machine import Chain
from matstd.twin.record import Labels, Setup
from matstd.twin.rows import picked, stacked
from matstd.twin.units import DEG

_GAP_MARGIN = 0.011  # mm: gaps are found to 0.01, readings in programs are rounded to 0.0001
_ANCHOR_SPARE = 5.0 * DEG  # an anchor stays away from where the ball ends above its stem


@dataclass(frozen=True, eq=False)
class _Touches:
    """Touches worked out in readings; fields as in `TouchPlan`."""

    feature: Labels
    point: Array
    normal: Array
    start: Array
    contact: Array
    direction: Array
    reason: Labels  # (N,), empty where nothing is against the touch

    def __getitem__(self, rows: IntArray | slice) -> "_Touches":
        return picked(self, rows)


def plan_touches(
    standard: Standard,
    chain: Chain,
    probe: Probe,
    setup: Setup,
    requests: Requests,
    options: PlanOptions | None = None,
    stated: StatedVisits | None = None,
) -> TouchPlan:
    """Plan of all touches of one set-up.

    Args:
        stated: Order and sides of the visits; in mixed order and from both sides without it.

    Raises:
        NotReachable: More requests refused than tolerated, a pose without room for the probe above
            or for the table to turn.
        DesignError: A machine or a feature that programs cannot name.
    """
    options = options or PlanOptions()
    options = replace(options, workshop=rounded_workshop(options.workshop))
    setup = rounded_setup(setup)
    task = PlanTask(chain=chain, probe=probe, standard=standard, setup=setup, options=options)
    ProgramFrame(chain, probe)  # refuses a machine that programs cannot name
    _check_requests(standard, chain, requests)
    # rounded first, so that plan and program state the same readings
    rotary = np.round(requests.rotary / GRID) * GRID
    if stated is None:
        stops = visits(chain, rotary, options.overshoot, options.shortest_visit)
    else:
        stops = stated_visits(chain, rotary, stated, options.overshoot)
    stops = _with_heights(task, stops)
    rounded = replace(requests, rotary=rotary)
    stops = _raised(task, stops, rounded)
    height = np.empty(len(requests))
    for stop in stops:
        height[stop.rows] = stop.height
    wanted = _cleared(task, rounded, height)
    refused = [_refusal(task, wanted, i, i) for i, r in enumerate(wanted.reason) if r]
    if len(refused) > options.tolerated:
        raise NotReachable(
            f"{len(refused)} of {len(requests)} touches cannot be made, "
            f"{options.tolerated} tolerated; the first: {refused[0]}",
            refused=refused,
        )
    plan, failed = _assembled(task, stops, wanted)
    return replace(plan, refused=tuple(refused + failed))


def _check_requests(standard: Standard, chain: Chain, requests: Requests) -> None:
    n = len(requests)
    shapes = [(n, 3), (n, 3), (n, len(chain.rotary_axes))]
    found = [requests.point.shape, requests.normal.shape, requests.rotary.shape]
    if shapes != found or len(requests.feature) != n or not n:
        raise ShapeMismatch(f"touch requests of shapes {found}, expected {shapes} and N > 0")
    for name in sorted(set(requests.feature.tolist())):
        if name not in standard.features:
            available = ", ".join(standard.features)
            raise DesignError(f"no feature '{name}' on {standard.name}; available: {available}")


def _with_heights(task: PlanTask, stops: list[Visit]) -> list[Visit]:
    """Visits with their clearance heights, after checking that the table can turn between them."""
    chain, probe, options = task.chain, task.probe, task.options
    solid = solid_hull(task.standard, task.setup, options.workshop)
    rotary = np.array([stop.rotary for stop in stops])
    tops = top_height(chain, rotary, solid, probe) + options.clearance
    heights = np.array([task.frame.whole(top) for top in tops])
    home = home_readings(chain)
    allowed, ways = task.top - 0.5 * options.clearance, [rotary_path(home, stops, home)]
    if chain.tool_rotary_axes:  # each may be the first or the last visit of a file
        ways += [rotary_path(home, [stop], home) for stop in stops]
    swing = max(
        swing_height(chain, path, solid, probe, allowed).max(initial=-np.inf) for path in ways
    )
    highest = max(heights.max(), swing + 0.5 * options.clearance)
    if highest > task.top:
        raise NotReachable(
            f"Z would have to rise to {highest:.1f} mm to clear standard and table while they "
            f"turn; it retracts to {task.top:.1f} mm"
        )
    return [replace(stop, height=float(h)) for stop, h in zip(stops, heights, strict=True)]


def _raised(task: PlanTask, stops: list[Visit], wanted: Requests) -> list[Visit]:
    """Visits raised above all starts of their touches, as far as Z retracts."""
    probing = task.reach()
    start = probing.readings(wanted, task.options.standoff)[:, task.frame.linear[2]]
    start = np.where(probing.is_reachable(wanted), start, -np.inf)
    out = []
    for stop in stops:
        highest = float(start[stop.rows].max(initial=-np.inf))
        if highest > stop.height:
            stop = replace(stop, height=min(task.frame.whole(highest), task.top))
        out.append(stop)
    return out


def _examined(task: PlanTask, wanted: Requests) -> _Touches:
    """Touches in readings, with the first reason against each."""
    options, probing = task.options, task.reach()
    contact = probing.readings(wanted)
    start = probing.readings(wanted, options.standoff)
    direction = (contact - start)[:, task.frame.linear] / options.standoff
    return _Touches(
        feature=wanted.feature,
        point=wanted.point,
        normal=wanted.normal,
        start=start,
        contact=contact,
        direction=direction,
        reason=probing.reasons(task.standard, wanted),
    )


def _cleared(task: PlanTask, wanted: Requests, height: Array) -> _Touches:
    """Touches in readings, some of them by another approach than along the normal.

    Reachable touches with room at the contact are tried from other sides before they are refused;
    the reported reason is that of the approach along the normal.
    """
    touches = _examined(task, wanted)
    if not task.options.is_swept:
        return touches
    touches = _swept(task, touches, height)
    is_open = (touches.reason != "") & task.reach().is_reachable(wanted)
    rows = np.flatnonzero(is_open)
    # without room at the contact no other approach helps
    room, _ = task.clearance.gap(touches.contact[rows])
    rows = rows[room >= task.options.smallest_gap]
    linear = task.frame.linear
    ways = Approaches(
        clearance=task.clearance,
        contact=touches.contact[rows],
        normal=touches.normal[rows],
        feature=touches.feature[rows],
        back=task.options.standoff,
        beyond=task.options.search,
    )
    for start, motion, is_good in ways.others() if len(rows) else ():
        left = np.flatnonzero(is_good & (touches.reason[rows] != ""))
        tried = replace(
            touches[rows[left]],
            start=start[left],
            direction=motion[left][:, linear],
            reason=np.full(len(left), "", dtype=touches.reason.dtype),
        )
        tried = _swept(task, tried, height[rows[left]])
        free = tried.reason == ""
        for name in ("start", "direction", "reason"):
            getattr(touches, name)[rows[left[free]]] = getattr(tried, name)[free]
    return touches


def _swept(task: PlanTask, touches: _Touches, height: Array) -> _Touches:
    """Touches with reasons added where the tool comes too close to an obstacle."""
    if not task.options.is_swept:
        return touches
    o, z, reason = task.options, task.chain.axis_index("Z"), touches.reason.copy()
    reason[(reason == "") & (touches.start[:, z] > height)] = "its start lies above the retract"
    rows = np.flatnonzero(reason == "")
    above = touches.start[rows].copy()
    above[:, z] = height[rows]
    clearance = task.clearance
    start, enough = touches.start[rows], max(SMALLEST_GAP + _GAP_MARGIN, o.smallest_gap)
    direction = np.zeros(start.shape)
    direction[:, task.frame.linear] = touches.direction[rows]
    looks = stroke_gaps(
        clearance,
        start,
        direction,
        back=np.full(len(rows), o.standoff),
        distance=np.full(len(rows), o.standoff + o.search),
        feature=touches.feature[rows],
        enough=enough,
    )
    down = clearance.swept_gap(above, start, enough=enough)
    for stage, (gap, nearest) in (*looks.items(), (Stage.WAY_IN, down)):
        least = stage.least_gap(task.probe.radius) + _GAP_MARGIN
        least = max(least, o.smallest_gap) if stage is Stage.TOUCH else least
        for i in np.flatnonzero(gap < least):
            # the first reason stands
            words = f"{gap[i]:.2f} mm between probe and {nearest[i]} {stage}"
            reason[rows[i]] = reason[rows[i]] or words
    return replace(touches, reason=reason)


def _refusal(task: PlanTask, touches: _Touches, row: int, request: int) -> Refusal:
    chain, q = task.chain, touches.contact[row]
    rotary = {a: float(q[chain.axis_index(a)]) for a in chain.rotary_axes}
    return Refusal(request, str(touches.feature[row]), rotary, str(touches.reason[row]))


def _anchors(task: PlanTask, stops: list[Visit]) -> dict[int, tuple[_Touches, Refusal | None]]:
    """The best possible anchor touch at every pose, or none and the reason."""
    poses = list({stop.pose: stop for stop in stops}.values())
    if not task.standard.spheres or not poses:
        return {}
    lots = [_anchor_requests(task, stop) for stop in poses]
    height = np.repeat([stop.height for stop in poses], [len(lot) for lot in lots])
    examined = _examined(task, joined(lots))
    ends = np.cumsum([len(lot) for lot in lots])
    lot = np.repeat(np.arange(len(lots)), [len(one) for one in lots])
    # a sweep costs a hundred times a static check: only candidates of choice are swept
    is_swept = np.zeros(len(lot), dtype=bool)
    while True:
        good = np.flatnonzero(examined.reason == "")
        best = good[np.unique(lot[good], return_index=True)[1]]
        rows = best[~is_swept[best]]
        if not len(rows):
            break
        examined.reason[rows] = _swept(task, examined[rows], height[rows]).reason
        is_swept[rows] = True
    return {
        stop.pose: _first_good(task, examined[slice(int(end) - len(lot), int(end))])
        for stop, lot, end in zip(poses, lots, ends, strict=True)
    }


def _anchor_requests(task: PlanTask, stop: Visit) -> Requests:
    """Possible anchor touches of a pose, best first."""
    options = task.options
    spheres = sorted(task.standard.spheres, key=lambda s: s.name != options.anchor)
    azimuth = np.asarray(120.0 * DEG * stop.pose + 60.0 * DEG * np.arange(6), dtype=np.float64)
    along = np.concatenate([ring_normals(options.anchor_tilt, azimuth), [[0.0, 0.0, 1.0]]])
    wanted = ring_requests(task.chain, task.setup, spheres, stop.rotary, along)
    normal = wanted.normal[: len(along)]
    # where the machine errs by some tenths of a millimetre the ball is met a few degrees lower
    lower = np.arcsin(np.clip(normal[:, 2], -1.0, 1.0)) - _ANCHOR_SPARE
    around = np.column_stack([np.zeros(len(along)), lower])
    return wanted[np.concatenate([s.contains(around) for s in spheres])]


def _assembled(
    task: PlanTask, stops: list[Visit], wanted: _Touches
) -> tuple[TouchPlan, list[Refusal]]:
    """The plan in order of execution, and refused anchors."""
    parts: list[_Touches] = []
    visit: list[int] = []
    request: list[int] = []
    failed: list[Refusal] = []
    kept: list[Visit] = []
    stops = [stop for stop in stops if np.any(wanted.reason[stop.rows] == "")]
    anchors = _anchors(task, stops)
    sideways = task.frame.linear[:2]  # every touch goes up and down
    for stop in stops:
        rows = stop.rows[wanted.reason[stop.rows] == ""]
        anchor, refusal = anchors.get(stop.pose, (wanted[rows[:0]], None))
        if refusal is not None:
            failed.append(refusal)
        first = anchor.start[0] if len(anchor.point) else wanted.start[rows[0]]
        order = short_order(wanted.start[rows][:, sideways], first[sideways])
        parts += [anchor, wanted[rows[order]]]
        request += [-1] * len(anchor.point) + rows[order].tolist()
        visit += [len(kept)] * (len(anchor.point) + len(rows))
        kept.append(stop)
    if not kept:
        raise NotReachable("no touch can be made", refused=failed)
    whole = stacked(parts)
    plan = TouchPlan(
        chain=task.chain,
        probe=task.probe,
        standard=task.standard,
        setup=task.setup,
        options=task.options,
        visits=tuple(kept),
        visit=np.array(visit),
        request=np.array(request),
        feature=whole.feature,
        point=whole.point,
        normal=whole.normal,
        start=whole.start,
        contact=whole.contact,
        direction=whole.direction,
    )
    return plan, failed


def _first_good(task: PlanTask, candidates: _Touches) -> tuple[_Touches, Refusal | None]:
    """The first possible candidate, or none and the refusal of the first."""
    good = np.flatnonzero(candidates.reason == "")
    return candidates[good[:1]], None if len(good) else _refusal(task, candidates, 0, -1)
