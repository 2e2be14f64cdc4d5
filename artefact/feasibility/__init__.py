"""Whether a brief can be met: what stands, what is reached, what fits, before anything is chosen.

In: a `Brief`. Out: `Feasibility`, with table poses to choose from, or what stands against it and
the nearest wishes that can be met. A new obstacle is a check here, with changes of the brief to
try.
"""

from matstd.artefact.feasibility.feasible import Feasibility, feasibility
from matstd.artefact.feasibility.room import (
    FEWEST_BALLS,
    Room,
    check_blank,
    check_room,
    light_enough,
    room_among,
    share_of_mass,
)
from matstd.artefact.feasibility.standing import check_beside, check_seat
from matstd.artefact.feasibility.touched import (
    in_the_way,
    is_from_side,
    mutually_probeable,
    touches_on,
    untouched,
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
    "light_enough",
    "mutually_probeable",
    "room_among",
    "share_of_mass",
    "touches_on",
    "untouched",
]
