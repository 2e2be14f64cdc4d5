"""Whether the machine reaches enough of the blank, and which change of the project would do if not.

A refusal names the travel or angle that binds and the nearest wishes that can be met, each of which
was tried.
"""

from collections.abc import Iterator
from dataclasses import dataclass, replace

import numpy as np

from matstd.artefact.brief import Brief
from matstd.artefact.feasibility.standing import RISEN, stands
from matstd.artefact.layout import with_spheres
from matstd.artefact.reach import (
    ANGLE,
    Limit,
    PlacesInReach,
    ProbeReach,
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

_RISER = 300.0  # mm above the table's face that a wish may lift a standard
_POSES = 60  # table poses that are tried
_PLACES_A_PATCH = 2  # reached, of a few hundred: with fewer no choice of patches was ever found
_SHIFTS = (20.0, 50.0, 100.0, 200.0, 400.0)  # mm
_SCALES = (1.0, 1.25, 1.5, 2.0, 3.0)  # of the shift by which single touches miss their travels
_LENGTHS = (-100.0, -50.0, -25.0, 25.0, 50.0, 100.0, 200.0)  # mm by which a probe may differ
_WIDER = 6  # steps in which a rotary range is widened to its travel
_TURNS = ((-90.0, 0.0, 0.0), (90.0, 0.0, 0.0), (0.0, 90.0, 0.0), (0.0, -90.0, 0.0))  # degrees
_NAMED = 3  # wishes named in a refusal
_ROUGH = 20  # table poses, and a third of the places, by which a wish is looked at first
TRIED = "place or turn of the set-up, length of the probe or range of a rotary axis"
"""What `nearest_in_reach` changes."""


@dataclass(frozen=True, eq=False)
class Wish:
    """A change of the project: its words, how large it is, and what is then asked of the machine.

    Attributes:
        words: Key and value of the project file.
        size: By which changes of one kind are ordered.
        kind: What is changed; one wish of a kind is named.
        reach: Machine, probe and set-up.
        rotary: Limits of the rotary axes, (R, 2), rad.
    """

    words: str
    size: float
    kind: str
    reach: ProbeReach
    rotary: Array


@dataclass(frozen=True, eq=False)
class Travels:
    """What of a blank the machine reaches.

    Attributes:
        tried: Places, table poses, and what is beyond which limit.
        poses: Table poses to choose from, (K, R), rad: where Z can rise above the standard.
        against: What binds, in words; empty where enough is reached.
    """

    tried: PlacesInReach
    poses: Array
    against: str = ""


def travels(brief: Brief) -> Travels:
    """What of a blank the machine reaches, at table poses where Z rises above the standard.

    Raises:
        NotReachable: Limits of a rotary axis without room to approach a reading from both sides.
    """
    wanted = brief.reach
    poses = poses_within(brief.chain, brief.rotary, brief.options.choice.poses)
    places, enough = places_on(brief.blank), _enough(brief)
    tried = reach_of(wanted, *places, spread_poses(poses, _POSES))
    rises = np.ones(len(poses), dtype=bool)
    if tried.places >= enough:  # whether Z rises is of no interest above what is not reached
        to_rise, retract = _to_rise(brief, wanted, poses)
        rises = to_rise <= retract
        if rises.any():
            tried = reach_of(wanted, *places, spread_poses(poses[rises], _POSES))
    against = ""
    if not rises.any():
        against = (
            f"Z would have to rise to {np.ceil(to_rise.min()):.0f} mm for the probe to clear "
            f"standard and table while they turn, it retracts to {retract:.0f} mm"
        )
    elif tried.places < enough:
        pose, asked = tried.wanting(enough)
        at = " ".join(
            f"{a}{v / DEG:+.0f}" for a, v in zip(brief.chain.rotary_axes, pose, strict=True)
        )
        against = (
            f"{tried.places} of {len(tried.point)} places of such a standard are within reach, "
            f"{enough} have to be; {f'even at {at} ' if at else ''}"
            f"{' and '.join(_asked(m, v) for m, v in asked)}"
        )
    return Travels(tried, poses[rises], against)


def nearest_in_reach(brief: Brief, tried: PlacesInReach) -> tuple[str, ...]:
    """Nearest changes of the project that bring enough within reach, in words; none if none does.

    Args:
        brief: Of which too little is reached.
        tried: What is.
    """
    return tuple(wish.words for wish in _nearest(brief, tried))


def _enough(brief: Brief) -> int:
    return _PLACES_A_PATCH * brief.options.patches


def _to_rise(brief: Brief, wanted: ProbeReach, poses: Array) -> tuple[Array, float]:
    """Reading of Z (K,) that a visit of a pose asks for at least, and the one it retracts to, mm.

    By what every standard has: its base, and its highest sphere, taken over the middle.
    """
    programs, chain = brief.programs, wanted.chain
    middle = np.array([0.0, 0.0, brief.blank.fittings.highest_sphere])
    least = with_spheres(brief.blank, [middle])
    solid = solid_hull(least, wanted.setup, wanted.workshop)
    tool = brief.probe.at_length(wanted.length)
    retract = chain.link("Z").range[1] - programs.retract
    to_rise = top_height(chain, poses, solid, tool) + programs.clearance
    turns = np.flatnonzero(to_rise <= retract)  # the way to the others is of no use
    home, ends = home_readings(chain), _beyond(brief.chain, poses)
    ways = [swing_height(chain, np.stack([home, ends[i]]), solid, tool)[0] for i in turns]
    turning = np.array(ways) + 0.5 * programs.clearance
    to_rise[turns] = np.maximum(to_rise[turns], turning)
    return to_rise, retract


def _beyond(chain: Chain, poses: Array) -> Array:
    """Poses (K, R) with the way beyond them from which they may be approached, where it exists."""
    travels = [chain.link(a).range for a in chain.rotary_axes]
    low, high = np.array(travels).reshape(-1, 2).T
    out = poses + OVERSHOOT * np.where(poses >= home_readings(chain), 1.0, -1.0)
    beyond: Array = np.where((out >= low) & (out <= high), out, poses)
    return beyond


def _fits(brief: Brief, wish: Wish) -> bool:
    """Whether a changed project is within reach; by few places and poses first."""
    lifted = replace(brief, riser=max(_RISER, brief.riser))
    if not stands(lifted, wish.reach.setup):
        return False
    grid = poses_within(brief.chain, wish.rotary, brief.options.choice.poses)
    for some, step in ((spread_poses(grid, _ROUGH), 3), (spread_poses(grid, _POSES), 1)):
        point, normal = (v[::step] for v in places_on(brief.blank))
        if reach_of(wish.reach, point, normal, some).places * step < _enough(brief):
            return False
    to_rise, retract = _to_rise(brief, wish.reach, some)
    good = some[to_rise <= retract]
    return reach_of(wish.reach, point, normal, good).places >= _enough(brief)


def _asked(limit: Limit, value: float) -> str:
    """What a limit would have to allow."""
    if limit.name == ANGLE:
        return (
            f"the probe would have to touch faces that look {np.ceil(value / DEG):.0f} degrees "
            f"away from the tool axis, {limit.at / DEG:g} at most"
        )
    end = np.ceil(value) if limit.upper else np.floor(value)
    return f"{limit.name} would have to go to {end:.0f} mm, its travel ends at {limit.at:g}"


def _nearest(brief: Brief, tried: PlacesInReach) -> list[Wish]:
    """The smallest change of every kind that would do."""
    found: dict[str, Wish] = {}
    wanted, rotary = brief.reach, brief.rotary
    wishes = [
        *_moved(brief, tried),
        *_wider(wanted, rotary),
        *_longer(wanted, rotary),
        *_turned(wanted, rotary),
        *_mirrored(wanted, rotary),
    ]
    for wish in sorted(wishes, key=lambda w: w.size):
        try:
            if wish.kind not in found and _fits(brief, wish):
                found[wish.kind] = wish
        except NotReachable:  # no room to approach a reading
            continue
    return list(found.values())[:_NAMED]


def _moved(brief: Brief, tried: PlacesInReach) -> Iterator[Wish]:
    """Along the axes of the table, and the way by which touches miss their travels."""
    wanted, rotary = brief.reach, brief.rotary
    chain, T = wanted.chain, wanted.setup.T_table_artefact
    ways = [(d, sign * s) for d in np.eye(3) for sign in (1.0, -1.0) for s in _SHIFTS]
    missed = np.zeros(3)
    pose, asked = tried.wanting(_enough(brief)) if len(tried.poses) else (rotary[:, 0], [])
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
        if up > max(RISEN, brief.riser):
            words += f" with limits.riser_mm = {np.ceil(up):.0f}"
        yield Wish(
            words=words,
            size=float(np.linalg.norm(shift)),
            kind="place",
            reach=replace(wanted, setup=setup),
            rotary=rotary,
        )


def _wider(wanted: ProbeReach, rotary: Array) -> Iterator[Wish]:
    """One rotary axis with more of its travel."""
    for i, name in enumerate(wanted.chain.rotary_axes):
        ends = np.array(wanted.chain.link(name).range)
        for step in range(1, _WIDER + 1):
            wide = rotary.copy()
            for to in ((0, 1), (0,), (1,)):
                wide = rotary.copy()
                wide[i, to] += (ends[[*to]] - wide[i, to]) * step / _WIDER
                words = ", ".join(f"{v / DEG:.0f}" for v in wide[i])
                size = float(np.abs(wide - rotary).sum() / DEG)
                yield Wish(
                    words=f"workspace.{name} = [{words}]",
                    size=size,
                    kind=f"range {name}",
                    reach=wanted,
                    rotary=wide,
                )


def _longer(wanted: ProbeReach, rotary: Array) -> Iterator[Wish]:
    for more in _LENGTHS:
        if wanted.length + more > 4.0 * wanted.radius:
            words = f"probe.length_mm = {wanted.length + more:g}"
            other = replace(wanted, length=wanted.length + more)
            yield Wish(words=words, size=abs(more), kind="length", reach=other, rotary=rotary)


def _turned(wanted: ProbeReach, rotary: Array) -> Iterator[Wish]:
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


def _mirrored(wanted: ProbeReach, rotary: Array) -> Iterator[Wish]:
    """Travels of axes that carry the workpiece, entered as motions of the table."""
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
