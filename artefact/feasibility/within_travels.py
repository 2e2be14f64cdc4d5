"""Whether the machine reaches enough of the blank, and which change of the project would help.

A refusal names the binding travel or angle and the nearest feasible changes. Changes are tried in
the order of their size, on few places and poses first; every named one passed the full check.
"""

from bisect import bisect_left
from collections.abc import Iterator
from dataclasses import dataclass, replace

import numpy as np

from matstd.artefact.brief import Brief
from matstd.artefact.feasibility.standing import SEAT_TOLERANCE, stands
from matstd.artefact.layout import with_spheres
from matstd.artefact.reach import (
    ANGLE,
    Limit,
    PlacesInReach,
    ProbeReach,
    Solid,
    places_on,
    reach_of,
    spread_poses,
)
from matstd.artefact.seat import seat_height
from matstd.artefact.tool import (
    OVERSHOOT,
    home_readings,
    readings_at,
    solid_hull,
    swing_height,
    top_height,
)
from matstd.artefact.worth import poses_within
from matstd.twin.errors import NotReachable
from matstd.twin.frames import Array, fixed_xyz
from matstd.twin.machine import Chain, linear_directions
from matstd.twin.record import Setup
from matstd.twin.units import DEG

_MAX_RISER = 300.0  # mm above the table to which a change may raise the standard
_POSES = 60  # table poses that are tried
_PLACES_A_PATCH = 2  # reached, of a few hundred: with fewer, no choice of patches was ever found
_LOWER_STEP = 10.0  # mm between two heights of a body that are tried
_SHIFTS = (20.0, 50.0, 100.0, 200.0, 400.0)  # mm
_SCALES = (1.0, 1.25, 1.5, 2.0, 3.0)  # multiples of the shift by which touches miss their travels
_LENGTHS = (-100.0, -50.0, -25.0, 25.0, 50.0, 100.0, 200.0)  # mm by which a probe may differ
_WIDENING_STEPS = 6  # steps in which a rotary range is widened to its travel
_TURNS = ((-90.0, 0.0, 0.0), (90.0, 0.0, 0.0), (0.0, 90.0, 0.0), (0.0, -90.0, 0.0))  # degrees
_MAX_WISHES = 3  # wishes named in a refusal
_FEW_POSES = 20  # table poses for the first check of a change, with a third of the places
TRIED_CHANGES = "place or turn of the set-up, length of the probe or range of a rotary axis"
"""What `nearest_in_reach` changes."""


@dataclass(frozen=True, eq=False)
class Wish:
    """A change of the project with the machine and limits that follow from it."""

    words: str
    size: float  # orders the changes of one kind
    kind: str  # what is changed; one change per kind is named
    reach: ProbeReach
    rotary: Array  # limits of the rotary axes, (R, 2), rad


@dataclass(frozen=True, eq=False)
class Travels:
    """The part of a blank that the machine reaches."""

    tried: PlacesInReach  # places, table poses, and the distances beyond the limits
    poses: Array  # candidate table poses, (K, R), rad, at which Z can rise above the standard
    against: str = ""  # binding limit, in words; empty where enough is reached
    # change of a body that brings enough within reach, in words; empty where none binds
    wish: str = ""


def travels(brief: Brief) -> Travels:
    """Check what the machine reaches of a blank where Z can rise above the standard.

    Raises:
        NotReachable: Limits of a rotary axis without room to approach a reading from both sides.
    """
    wanted = brief.reach
    poses = poses_within(brief.chain, brief.rotary, brief.options.choice.poses)
    places, enough = places_on(brief.blank), _min_places(brief)
    tried = reach_of(wanted, *places, spread_poses(poses, _POSES))
    rises = np.ones(len(poses), dtype=bool)
    if tried.places >= enough:  # Z need not rise above a blank that is out of reach
        to_rise, retract = _to_rise(brief, wanted, poses)
        rises = to_rise <= retract
        if rises.any():
            tried = reach_of(wanted, *places, spread_poses(poses[rises], _POSES))
    against = wish = ""
    if not rises.any():
        name, wish = _lower_body(brief, wanted, spread_poses(poses, _POSES))
        against = (
            f"Z would have to rise to {np.ceil(to_rise.min()):.0f} mm for the probe to clear "
            f"{name or 'standard and table'} while they turn, it retracts to {retract:.0f} mm"
        )
    elif tried.places < enough:
        pose, asked = tried.wanting(enough)
        at = " ".join(
            f"{a}{v / DEG:+.0f}" for a, v in zip(brief.chain.rotary_axes, pose, strict=True)
        )
        against = (
            f"{tried.places} of {len(tried.point)} places of such a standard are within reach, "
            f"{enough} have to be; {f'even at {at} ' if at else ''}"
            f"{' and '.join(_limit_words(m, v) for m, v in asked)}"
        )
    return Travels(tried, poses[rises], against, wish)


def _min_places(brief: Brief) -> int:
    return _PLACES_A_PATCH * brief.options.patches


def _to_rise(brief: Brief, wanted: ProbeReach, poses: Array) -> tuple[Array, float]:
    """Smallest reading of Z (K,) for a visit of each pose, and its retracted reading, mm.

    Estimated from the base and the highest sphere, which every standard has.
    """
    programs, chain = brief.programs, wanted.chain
    middle = np.array([0.0, 0.0, brief.blank.fittings.highest_sphere])
    least = with_spheres(brief.blank, [middle])
    solid = solid_hull(least, wanted.setup, wanted.workshop)
    tool = brief.probe.at_length(wanted.length)
    retract = chain.link("Z").range[1] - programs.retract
    to_rise = top_height(chain, poses, solid, tool) + programs.clearance
    turns = np.flatnonzero(to_rise <= retract)  # other poses cannot be used anyway
    home, ends = home_readings(chain), _with_overshoot(brief.chain, poses)
    ways = [swing_height(chain, np.stack([home, ends[i]]), solid, tool)[0] for i in turns]
    turning = np.array(ways) + 0.5 * programs.clearance
    to_rise[turns] = np.maximum(to_rise[turns], turning)
    return to_rise, retract


def _lower_body(brief: Brief, wanted: ProbeReach, poses: Array) -> tuple[str, str]:
    """The body above which Z cannot rise, and the height at which it can; "" where it is none."""
    bodies = wanted.workshop.bodies
    for number, body in enumerate(bodies):

        def rises(high: float, number: int = number, body: Solid = body) -> bool:
            lower = replace(body, high=high)
            changed = (*bodies[:number], lower, *bodies[number + 1 :])
            reach = replace(wanted, workshop=replace(wanted.workshop, bodies=changed))
            to_rise, retract = _to_rise(brief, reach, poses)
            return bool(np.any(to_rise <= retract))

        steps = np.arange(body.low + _LOWER_STEP, body.high, _LOWER_STEP).tolist()
        low_enough = steps[: bisect_left(steps, True, key=lambda high: not rises(high))]
        if low_enough:
            size = f"{body.high - body.low:.0f} mm high"
            return (
                f"{body.name}, {size},",
                f"a height of {low_enough[-1] - body.low:.0f} mm of {body.name}",
            )
    return "", ""


def _with_overshoot(chain: Chain, poses: Array) -> Array:
    """Poses (K, R) moved to the start of their approach, where the travel allows it."""
    travels = [chain.link(a).range for a in chain.rotary_axes]
    low, high = np.array(travels).reshape(-1, 2).T
    out = poses + OVERSHOOT * np.where(poses >= home_readings(chain), 1.0, -1.0)
    return np.where((out >= low) & (out <= high), out, poses)


def _fits(brief: Brief, wish: Wish) -> bool:
    """Whether a changed project is within reach; few places and poses are checked first."""
    lifted = replace(brief, riser=max(_MAX_RISER, brief.riser))
    if not stands(lifted, wish.reach.setup):
        return False
    grid = poses_within(brief.chain, wish.rotary, brief.options.choice.poses)
    for some, step in ((spread_poses(grid, _FEW_POSES), 3), (spread_poses(grid, _POSES), 1)):
        point, normal = (v[::step] for v in places_on(brief.blank))
        if reach_of(wish.reach, point, normal, some).places * step < _min_places(brief):
            return False
    to_rise, retract = _to_rise(brief, wish.reach, some)
    good = some[to_rise <= retract]
    return reach_of(wish.reach, point, normal, good).places >= _min_places(brief)


def _limit_words(limit: Limit, value: float) -> str:
    """The value that a limit would have to allow, in words."""
    if limit.name == ANGLE:
        return (
            f"the probe would have to touch faces that look {np.ceil(value / DEG):.0f} degrees "
            f"away from the tool axis, {limit.at / DEG:g} at most"
        )
    end = np.ceil(value) if limit.upper else np.floor(value)
    return f"{limit.name} would have to go to {end:.0f} mm, its travel ends at {limit.at:g}"


def nearest_in_reach(brief: Brief, tried: PlacesInReach) -> tuple[str, ...]:
    """The smallest change of every kind that brings enough places within reach, in words."""
    found: dict[str, Wish] = {}
    wanted, rotary = brief.reach, brief.rotary
    wishes = [
        *_moved_setups(brief, tried),
        *_wider_ranges(wanted, rotary),
        *_other_lengths(wanted, rotary),
        *_turned_setups(wanted, rotary),
        *_mirrored_travels(wanted, rotary),
    ]
    for wish in sorted(wishes, key=lambda w: w.size):
        try:
            if wish.kind not in found and _fits(brief, wish):
                found[wish.kind] = wish
        except NotReachable:  # no room to approach a reading
            continue
    return tuple(wish.words for wish in found.values())[:_MAX_WISHES]


def _moved_setups(brief: Brief, tried: PlacesInReach) -> Iterator[Wish]:
    """Set-ups moved along the axes of the table, and by the distance that touches miss."""
    wanted, rotary = brief.reach, brief.rotary
    chain, T = wanted.chain, wanted.setup.T_table_artefact
    ways = [(d, sign * s) for d in np.eye(3) for sign in (1.0, -1.0) for s in _SHIFTS]
    missed = np.zeros(3)
    pose, asked = tried.wanting(_min_places(brief)) if len(tried.poses) else (rotary[:, 0], [])
    along = linear_directions(chain, readings_at(chain, pose[None]))[0]
    for limit, value in asked:
        if limit.name != ANGLE:
            missed -= (value - limit.at) * along[:, chain.linear_axes.index(limit.name)]
    for direction, size in [*ways, *((missed, scale) for scale in _SCALES if missed.any())]:
        shift = 10.0 * np.sign(direction * size) * np.ceil(np.abs(direction * size) / 10.0 - 1e-6)
        moved = T.copy()
        moved[:3, 3] += shift
        place = ", ".join(f"{v + 0.0:.0f}" for v in moved[:3, 3])
        setup = Setup(wanted.setup.name, moved)
        words = f"setup.{setup.name}.origin_mm = [{place}]"
        up = seat_height(moved, brief.blank.base.half_size) - brief.table.high
        if up > max(SEAT_TOLERANCE, brief.riser):
            words += f" with limits.riser_mm = {np.ceil(up):.0f}"
        yield Wish(
            words=words,
            size=float(np.linalg.norm(shift)),
            kind="place",
            reach=replace(wanted, setup=setup),
            rotary=rotary,
        )


def _wider_ranges(wanted: ProbeReach, rotary: Array) -> Iterator[Wish]:
    """One rotary axis with more of its travel."""
    for i, name in enumerate(wanted.chain.rotary_axes):
        ends = np.array(wanted.chain.link(name).range)
        for step in range(1, _WIDENING_STEPS + 1):
            wide = rotary.copy()
            for to in ((0, 1), (0,), (1,)):
                wide = rotary.copy()
                wide[i, to] += (ends[[*to]] - wide[i, to]) * step / _WIDENING_STEPS
                words = ", ".join(f"{v / DEG:.0f}" for v in wide[i])
                size = float(np.abs(wide - rotary).sum() / DEG)
                yield Wish(
                    words=f"workspace.{name} = [{words}]",
                    size=size,
                    kind=f"range {name}",
                    reach=wanted,
                    rotary=wide,
                )


def _other_lengths(wanted: ProbeReach, rotary: Array) -> Iterator[Wish]:
    for more in _LENGTHS:
        if wanted.length + more > 4.0 * wanted.radius:
            words = f"probe.length_mm = {wanted.length + more:g}"
            other = replace(wanted, length=wanted.length + more)
            yield Wish(words=words, size=abs(more), kind="length", reach=other, rotary=rotary)


def _turned_setups(wanted: ProbeReach, rotary: Array) -> Iterator[Wish]:
    for angles in _TURNS:
        T = wanted.setup.T_table_artefact.copy()
        T[:3, :3] = fixed_xyz(np.array(angles) * DEG)
        setup = Setup(wanted.setup.name, T)
        words = ", ".join(f"{v:g}" for v in angles)
        yield Wish(
            words=f"setup.{setup.name}.rotation_deg = [{words}]",
            size=90.0,
            kind="turn",
            reach=replace(wanted, setup=setup),
            rotary=rotary,
        )


def _mirrored_travels(wanted: ProbeReach, rotary: Array) -> Iterator[Wish]:
    """Reversed travels of workpiece axes, in case they were entered as table motions."""
    links = wanted.chain.links
    carried = [k for k in links if k.kind == "linear" and k.carries_workpiece]
    for some in [*([k] for k in carried), *[carried] * (len(carried) > 1)]:
        ends = {k.name: (-k.range[1] + 0.0, -k.range[0] + 0.0) for k in some}
        mirrored = tuple(replace(k, range=ends.get(k.name, k.range)) for k in links)
        words = [f"axis.{name}.range = [{low:g}, {high:g}]" for name, (low, high) in ends.items()]
        yield Wish(
            words=f"{' with '.join(words)} of the machine (readings move the tool relative to the "
            "workpiece)",
            size=1.0,
            kind="sign",
            reach=replace(wanted, chain=replace(wanted.chain, links=mirrored)),
            rotary=rotary,
        )
