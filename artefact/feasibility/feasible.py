"""Whether a brief can be met, checked before anything is chosen.

    travels: enough of the blank is reached -> room: the patches fit side by side and can be touched

The first failing check becomes the refusal. Changes of the project are then tried, and the nearest
feasible one of every kind is named.
"""

from dataclasses import dataclass

from matstd.artefact.brief import Brief
from matstd.artefact.feasibility.room import Room, check_room
from matstd.artefact.feasibility.side_by_side import nearest_that_fits, room_of
from matstd.artefact.feasibility.within_travels import TRIED_CHANGES, nearest_in_reach, travels
from matstd.artefact.reach import PlacesInReach
from matstd.twin.errors import DesignError, NotBuildable, NotReachable
from matstd.twin.frames import Array


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
