"""Makes a plan: works out every touch, refuses what cannot be made, puts the rest in order."""

from dataclasses import dataclass, replace

import numpy as np

from artefact.standard import Standard
from artefact.touchable import Requests
from probe_paths.clearance import Room, obstacles, readings_at, swing_height, top_height
from probe_paths.frame import LINEAR, ProgramFrame
from probe_paths.heading import rounded_setup
from probe_paths.order import Visit, home_readings, nearest_neighbours, rotary_path, visits
from probe_paths.plan import GRID, PlanOptions, Refusal, TouchPlan
from probe_paths.probe import Probe
from twin.chain import Chain
from twin.errors import DesignError, NotReachable, ShapeMismatch
from twin.frames import Array, apply, turn
from twin.kinematics import inverse_linear, linear_directions, table_to_tool
from twin.touches import IntArray, Labels, Setup
from twin.units import DEG

_MARGIN = 1.0  # mm added to the ball on its way down from the clearance height


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
        return _Touches(*(getattr(self, name)[rows] for name in self.__dataclass_fields__))


def plan_touches(
    standard: Standard,
    chain: Chain,
    probe: Probe,
    setup: Setup,
    requests: Requests,
    options: PlanOptions | None = None,
) -> TouchPlan:
    """Plan of all touches of one set-up.

    Args:
        standard: What is touched.
        chain: The machine.
        probe: In the spindle.
        setup: Where the standard is believed to stand.
        requests: Wanted touches, at any poses, in any order.
        options: How carefully.

    Raises:
        NotReachable: More requests refused than tolerated, a pose without room for the probe above
            or for the table to turn.
        DesignError: A machine or a feature that programs cannot name.
    """
    options = options or PlanOptions()
    setup = rounded_setup(setup)
    ProgramFrame(chain, probe)
    _check_requests(standard, chain, requests)
    rotary = np.round(requests.rotary / GRID) * GRID
    room = Room(chain, standard, setup, probe, options.table_radius)
    stops = visits(chain, rotary, options.overshoot, options.shortest_visit)
    stops = _with_heights(room, stops, options)
    height = np.empty(len(requests))
    for stop in stops:
        height[stop.rows] = stop.height
    wanted = _worked_out(room, requests.feature, requests.point, requests.normal, rotary, options)
    wanted = _looked_at(room, wanted, height, options)
    refused = [Refusal(i, str(r)) for i, r in enumerate(wanted.reason) if r]
    if len(refused) > options.tolerated:
        raise NotReachable(
            f"{len(refused)} of {len(requests)} touches cannot be made, "
            f"{options.tolerated} tolerated; the first: {refused[0].reason}",
            refused=refused,
        )
    plan, failed = _assembled(room, stops, wanted, options)
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


def _with_heights(room: Room, stops: list[Visit], options: PlanOptions) -> list[Visit]:
    """Visits with their clearance heights, after checking that the table can turn between them."""
    chain, probe = room.chain, room.probe
    solid = obstacles(room.standard, room.setup, options.table_radius)
    retract = chain.link("Z").range[1] - options.retract
    rotary = np.array([stop.rotary for stop in stops])
    frame = ProgramFrame(chain, probe)
    heights = top_height(chain, rotary, solid, probe) + options.clearance
    # whole millimetres in the program: an operator reads them at a glance
    heights = np.array([frame.reading("Z", np.ceil(frame.coordinate("Z", h))) for h in heights])
    home = home_readings(chain)
    swing = swing_height(chain, rotary_path(home, stops, home), solid, probe).max(initial=-np.inf)
    highest = max(heights.max(), swing + 0.5 * options.clearance)
    if highest > retract:
        raise NotReachable(
            f"Z would have to rise to {highest:.1f} mm to clear standard and table while they "
            f"turn; it retracts to {retract:.1f} mm"
        )
    return [replace(stop, height=float(h)) for stop, h in zip(stops, heights, strict=True)]


def _worked_out(
    room: Room, feature: Labels, point: Array, normal: Array, rotary: Array, options: PlanOptions
) -> _Touches:
    """Readings and probing directions of touches; reasons still empty."""
    chain, probe = room.chain, room.probe
    T_table_artefact = room.setup.T_table_artefact
    p, n = apply(T_table_artefact, point), turn(T_table_artefact, normal)
    q = readings_at(chain, rotary)
    contact = inverse_linear(chain, p + probe.radius * n, q, probe.length)
    start = inverse_linear(chain, p + (probe.radius + options.standoff) * n, q, probe.length)
    linear = [chain.axis_index(name) for name in LINEAR]
    direction = (contact - start)[:, linear] / options.standoff
    empty = np.full(len(point), "", dtype="U200")
    return _Touches(feature, point, normal, start, contact, direction, empty)


def _looked_at(room: Room, touches: _Touches, height: Array, options: PlanOptions) -> _Touches:
    """Touches with the first reason against each."""
    chain = room.chain
    T_table_tool = table_to_tool(chain, touches.contact)
    n = turn(room.setup.T_table_artefact, touches.normal)
    angle = np.arccos(np.clip(np.einsum("ni,ni->n", n, T_table_tool[:, :3, 2]), -1.0, 1.0))
    reasons = [
        np.where(
            angle > options.steepest,
            [f"the surface leans {a / DEG:.1f} degrees from the tool axis" for a in angle],
            "",
        ),
        _travel_reasons(chain, touches, options),
    ]
    for q in (touches.start, touches.contact):
        gap, nearest = room.gap(q)
        words = [f"{g:.2f} mm between probe and {b}" for g, b in zip(gap, nearest, strict=True)]
        reasons.append(np.where(gap < options.room, words, ""))
    reasons.append(_way_reasons(room, touches, height, options))
    against = reasons[0]
    for other in reasons[1:]:
        against = np.where(against == "", other, against)
    named = [
        f"{f}, {_pose_words(chain, q)}: {r}" if r else ""
        for f, q, r in zip(touches.feature, touches.contact, against, strict=True)
    ]
    return replace(touches, reason=np.array(named, dtype="U200"))


def _pose_words(chain: Chain, q: Array) -> str:
    return " ".join(f"{a}{q[chain.axis_index(a)] / DEG:+.1f}" for a in chain.rotary_axes)


def _travel_reasons(chain: Chain, touches: _Touches, options: PlanOptions) -> Labels:
    """Start, contact and end of the search stay within the travels."""
    reason = np.full(len(touches.point), "", dtype="U200")
    for i, name in enumerate(LINEAR):
        column = chain.axis_index(name)
        low, high = chain.link(name).range
        begin = touches.start[:, column]
        end = touches.contact[:, column] + options.search * touches.direction[:, i]
        for value in (begin, end):
            outside = (value < low) | (value > high)
            words = [f"{name} would have to go to {v:.1f}, {low:g} to {high:g} mm" for v in value]
            reason = np.where(outside & (reason == ""), words, reason)
    return reason


def _way_reasons(room: Room, touches: _Touches, height: Array, options: PlanOptions) -> Labels:
    """The way down to the start is free, and the first thing met is the wanted feature."""
    chain, z = room.chain, room.chain.axis_index("Z")
    above = touches.start.copy()
    above[:, z] = height
    up = linear_directions(chain, above)[:, :, chain.linear_axes.index("Z")]
    down = room.met(above, -up, height - touches.start[:, z], _MARGIN)
    towards = -turn(room.setup.T_table_artefact, touches.normal)
    reach = np.full(len(height), options.standoff + options.search)
    met = room.met(touches.start, towards, reach, 0.0)
    expected = np.array([f"meets the surface of {f}" for f in touches.feature])
    no_room = touches.start[:, z] > height
    reason = np.where(down != "", np.char.add("on its way down the ball ", down), "")
    reason = np.where(no_room, "its start lies above the clearance height", reason)
    nothing = np.where(met == "", "meets nothing", met)
    return np.where((reason == "") & (met != expected), np.char.add("the ball ", nothing), reason)


def _anchors(room: Room, stop: Visit, options: PlanOptions) -> _Touches:
    """Possible anchor touches of a pose, best first, with what is against each."""
    spheres = sorted(room.standard.spheres, key=lambda s: s.name != options.anchor)
    q = readings_at(room.chain, stop.rotary[None])
    R_table_tool = table_to_tool(room.chain, q)[0, :3, :3]
    azimuth = 120.0 * DEG * stop.pose + 60.0 * DEG * np.arange(6)
    sin, cos = np.sin(options.anchor_tilt), np.cos(options.anchor_tilt)
    local = np.stack([sin * np.cos(azimuth), sin * np.sin(azimuth), np.full(6, cos)], axis=-1)
    tilted = np.concatenate([local, [[0.0, 0.0, 1.0]]]) @ R_table_tool.T
    normal = tilted @ room.setup.T_table_artefact[:3, :3]
    feature = np.repeat([s.name for s in spheres], len(normal))
    point = np.concatenate([s.centre + s.radius * normal for s in spheres])
    normal = np.tile(normal, (len(spheres), 1))
    rotary = np.repeat(stop.rotary[None], len(point), axis=0)
    found = _worked_out(room, feature, point, normal, rotary, options)
    return _looked_at(room, found, np.full(len(point), stop.height), options)


def _assembled(
    room: Room, stops: list[Visit], wanted: _Touches, options: PlanOptions
) -> tuple[TouchPlan, list[Refusal]]:
    """The plan in order of execution, and anchors that no pose could be given."""
    parts: list[_Touches] = []
    visit: list[int] = []
    request: list[int] = []
    failed: list[Refusal] = []
    kept: list[Visit] = []
    anchors: dict[int, tuple[_Touches, str]] = {}
    linear = [room.chain.axis_index(name) for name in LINEAR]
    for stop in stops:
        rows = stop.rows[wanted.reason[stop.rows] == ""]
        if not len(rows):
            continue
        if stop.pose not in anchors and room.standard.spheres:
            anchors[stop.pose] = _first_good(_anchors(room, stop, options))
        anchor, why = anchors.get(stop.pose, (wanted[rows[:0]], ""))
        if why:
            failed.append(Refusal(-1, f"no anchor touch: {why}"))
        first = anchor.start[0] if len(anchor.point) else wanted.start[rows[0]]
        order = nearest_neighbours(wanted.start[rows][:, linear], first[linear])
        parts += [anchor, wanted[rows[order]]]
        request += [-1] * len(anchor.point) + rows[order].tolist()
        visit += [len(kept)] * (len(anchor.point) + len(rows))
        kept.append(stop)
    if not kept:
        raise NotReachable("no touch can be made", refused=failed)
    plan = TouchPlan(
        chain=room.chain,
        probe=room.probe,
        standard=room.standard,
        setup=room.setup,
        options=options,
        visits=tuple(kept),
        visit=np.array(visit),
        request=np.array(request),
        feature=np.concatenate([part.feature for part in parts]),
        point=np.concatenate([part.point for part in parts]),
        normal=np.concatenate([part.normal for part in parts]),
        start=np.concatenate([part.start for part in parts]),
        contact=np.concatenate([part.contact for part in parts]),
        direction=np.concatenate([part.direction for part in parts]),
    )
    return plan, failed


def _first_good(candidates: _Touches) -> tuple[_Touches, str]:
    """The first candidate that nothing is against, or none and the reason against the first."""
    good = np.flatnonzero(candidates.reason == "")
    if len(good):
        return candidates[good[:1]], ""
    return candidates[good], str(candidates.reason[0])
