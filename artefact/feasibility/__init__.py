"""Whether a brief can be met, before anything is chosen: clamping, reach, room and mass.

In: a `Brief`. Out: `Feasibility`, with table poses to choose from, or the binding limit and the
nearest feasible requests. A new obstacle is a check here, with changes of the brief to
try.
"""

from matstd.artefact.feasibility.feasible import Feasibility, feasibility
from matstd.artefact.feasibility.room import (
    FEWEST_BALLS,
    Room,
    check_blank,
    check_room,
    lightest_room,
    mass_per_face,
    room_among,
)
from matstd.artefact.feasibility.standing import check_beside, check_seat, stands
from matstd.artefact.feasibility.touched import (
    in_the_way,
    is_from_side,
    mutually_probeable,
    touches_on,
    untouchable_faces,
)

__all__ = [
    "FEWEST_BALLS",
    "Feasibility",
    "Room",
    "check_beside",
    "check_blank",
    "check_room",
    "check_seat",
    "feasibility",
    "in_the_way",
    "is_from_side",
    "lightest_room",
    "mass_per_face",
    "mutually_probeable",
    "room_among",
    "stands",
    "touches_on",
    "untouchable_faces",
]
