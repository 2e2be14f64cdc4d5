"""Whether a brief can be met, checked before anything is chosen.

    travels: enough of the blank is reached -> room: the patches fit side by side and can be touched

The first failing check becomes the refusal. Changes of the project are then tried, and the nearest
feasible one of every kind is named.
"""

from collections.abc import Iterator
from dataclasses import dataclass, replace

import numpy as np

from matstd.artefact.brief import FEWEST_PATCHES, LEAST_SIDE, Brief, base_of
from matstd.artefact.feasibility.room import Room, check_room, room_for
from matstd.artefact.feasibility.within_travels import TRIED_CHANGES, nearest_in_reach, travels
from matstd.artefact.layout import WALL_GAP, least_gap
from matstd.artefact.reach import PlacesInReach
from matstd.twin.errors import DesignError, NotBuildable, NotReachable
from matstd.twin.frames import Array
from matstd.twin.units import DEG

_LARGER, _SMALLER = (1.1, 1.25, 1.5), (0.95, 0.9, 0.85)  # sides of the blank
_GAP_SHARES = (0.5, 0.2)  # of the gap
_SLOPE_STEPS = (5.0, 15.0, 30.0)  # degrees
_MAX_SLOPE = 60.0  # degrees, that any face has


@dataclass(frozen=True, eq=False)
class Feasibility:
    """Result of the feasibility checks of a brief."""

    places: PlacesInReach
    poses: Array  # candidate table poses, (K, R), rad, at which Z can rise above the standard
    # patches that stand side by side; None where too little is reached, or where the project asks
    # for no small faces
    room: Room | None = None
    # binding limit with the feasible changes that were found; None where nothing binds
    refusal: DesignError | None = None

    def check(self) -> None:
        """Raise the refusal, if any.

        Raises:
            NotReachable: Fewer places than a standard needs; which limit binds, the nearest wishes.
            NotBuildable: What binds (facts `fitting`, `binding`), and the nearest `wishes`.
        """
        if self.refusal is not None:
            raise self.refusal


def feasibility(brief: Brief) -> Feasibility:
    """Check reach and room of a brief; where one fails, search for the nearest feasible changes.

    Raises:
        NotReachable: Limits of a rotary axis without room to approach a reading from both sides.
        NotBuildable: No screw holes, or no face at all, on such a blank.
    """
    found = travels(brief)
    if found.against:
        wishes = () if found.wish else nearest_in_reach(brief, found.tried)
        nearest = (
            found.wish or " or ".join(wishes) or f"of those that were tried, no {TRIED_CHANGES}"
        )
        beyond = NotReachable(f"{brief.path}: {found.against}; {nearest} would do")
        return Feasibility(found.tried, found.poses, refusal=beyond)
    if brief.options.family in ("auto", "wavy", "balls"):  # no small face is a condition
        return Feasibility(found.tried, found.poses)
    room = room_of(brief, found.poses)
    try:
        check_room(room)
    except NotBuildable as error:
        wanted = nearest_that_fits(brief, room, found.poses)
        refusal = NotBuildable(str(error), **error.facts, wishes=wanted)
        return Feasibility(found.tried, found.poses, room, refusal)
    return Feasibility(found.tried, found.poses, room)


def room_of(brief: Brief, poses: Array) -> Room:
    """Room for the patches of a brief, at table poses (K, R), rad."""
    wanted = brief.options
    return room_for(wanted.patches, brief.reach, brief.blank, poses, wanted.sites, brief.seed)


def nearest_that_fits(brief: Brief, room: Room, poses: Array) -> list[str]:
    """The smallest feasible change of every kind, in words."""
    found = []
    if not room.is_light:  # the mass of the lightest one is known
        found.append(f"limits.max_mass_kg = {np.ceil(10.0 * room.least) / 10.0:g}")
    kinds = (_fewer_patches, _smaller_gaps, _steeper_faces, _resized_blanks)
    for wishes in (kind(brief, room) for kind in kinds):
        for words, other in wishes:
            try:
                there = room_of(other, poses)
            except NotBuildable:
                continue
            if there.is_enough and there.is_light:
                found.append(words)
                break
    return found


def _fewer_patches(brief: Brief, room: Room) -> Iterator[tuple[str, Brief]]:
    """As many patches as fit, or one less, because fewer patches are larger."""
    for fewer in (len(room.faces), len(room.faces) - 1):
        if fewer >= FEWEST_PATCHES and not room.is_enough:
            other = replace(brief, options=replace(brief.options, patches=fewer))
            yield f"standard.patches = {fewer}", other


def _smaller_gaps(brief: Brief, room: Room) -> Iterator[tuple[str, Brief]]:
    """A smaller gap, where the gap and not the cutter separates the bodies."""
    gap = brief.blank.limits.gap
    for share in (
        _GAP_SHARES if least_gap(room.blank.limits) > WALL_GAP and not room.is_enough else ()
    ):
        closer = float(round(share * gap))
        yield f"limits.gap_mm = {closer:g}", _with_limits(brief, gap=closer)


def _steeper_faces(brief: Brief, room: Room) -> Iterator[tuple[str, Brief]]:
    """Steeper faces, which face a probe that cannot reach them otherwise."""
    for more in _SLOPE_STEPS if room.is_hidden else ():
        if (slope := round(brief.blank.limits.max_slope / DEG, 6) + more) <= _MAX_SLOPE:
            yield f"limits.max_slope_deg = {slope:g}", _with_limits(brief, max_slope=slope * DEG)


def _resized_blanks(brief: Brief, room: Room) -> Iterator[tuple[str, Brief]]:
    """A smaller blank for less mass, a larger one for more room."""
    factors = () if room.is_hidden else _LARGER if room.is_light else _SMALLER
    for factor in factors:
        a, b = (round(factor * 2.0 * half) for half in brief.blank.base.half_size)
        if min(a, b) >= LEAST_SIDE and max(a, b) <= 2.0 * brief.reach.table_radius:
            other = replace(brief.blank, base=base_of((a, b)))
            yield f"blank.base_mm = [{a}, {b}]", replace(brief, blank=other)


def _with_limits(brief: Brief, **limits: float) -> Brief:
    """The brief with other limits of its blank."""
    blank = brief.blank
    return replace(brief, blank=replace(blank, limits=replace(blank.limits, **limits)))
