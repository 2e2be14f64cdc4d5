"""Whether a brief can be met, looked at before anything is chosen.

    travels: enough of the blank is reached -> room: the patches stand side by side and are touched

What fails first is the refusal; changes of the project by which it would hold are tried, the
nearest of every kind is named.
"""

from dataclasses import dataclass

from matstd.artefact.brief import Brief
from matstd.artefact.feasibility.room import Room, check_room
from matstd.artefact.feasibility.side_by_side import nearest_that_fits, room_of
from matstd.artefact.feasibility.within_travels import TRIED, nearest_in_reach, travels
from matstd.artefact.reach import PlacesInReach
from matstd.twin.errors import DesignError, NotBuildable, NotReachable
from matstd.twin.frames import Array


@dataclass(frozen=True, eq=False)
class Feasibility:
    """What of a brief the machine can do.

    Attributes:
        places: What it reaches of the blank.
        poses: Table poses to choose from, (K, R), rad: where Z can rise above the standard.
        room: Patches that stand side by side; None where too little is reached.
        refusal: What stands against the brief, with the wishes that were tried and would do; None
            where nothing does.
    """

    places: PlacesInReach
    poses: Array
    room: Room | None = None
    refusal: DesignError | None = None

    def check(self) -> None:
        """Raise what stands against the brief.

        Raises:
            NotReachable: Fewer places than a standard needs; which limit binds, the nearest wishes.
            NotBuildable: What binds (facts `fitting`, `binding`), and the nearest `wishes`.
        """
        if self.refusal is not None:
            raise self.refusal


def feasibility(brief: Brief) -> Feasibility:
    """What of a brief the machine can do; where that is too little, what would do.

    Raises:
        NotReachable: Limits of a rotary axis without room to approach a reading from both sides.
        NotBuildable: No screw holes, or no face at all, on such a blank.
    """
    found = travels(brief)
    if found.against:
        wishes = nearest_in_reach(brief, found.tried)
        nearest = " or ".join(wishes) or f"no other {TRIED} alone"
        beyond = NotReachable(f"{brief.path}: {found.against}; {nearest} would do")
        return Feasibility(found.tried, found.poses, refusal=beyond)
    room = room_of(brief, found.poses)
    try:
        check_room(room)
    except NotBuildable as error:
        wanted = nearest_that_fits(brief, room, found.poses)
        refusal = NotBuildable(str(error), **error.facts, wishes=wanted)
        return Feasibility(found.tried, found.poses, room, refusal)
    return Feasibility(found.tried, found.poses, room)
