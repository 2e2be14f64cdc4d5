"""Whether a brief can be met, before anything is chosen: clamping, reach, room and mass.

In: a `Brief`. Out: `Feasibility`, with table poses to choose from, or the binding limit and the
nearest feasible requests. A new obstacle is a check here, with changes of the brief to
try.
"""

from matstd.artefact.feasibility.feasible import Feasibility as Feasibility
from matstd.artefact.feasibility.feasible import feasibility as feasibility
from matstd.artefact.feasibility.room import FEWEST_BALLS as FEWEST_BALLS
from matstd.artefact.feasibility.room import Room as Room
from matstd.artefact.feasibility.room import check_blank as check_blank
from matstd.artefact.feasibility.room import check_room as check_room
from matstd.artefact.feasibility.room import lightest_room as lightest_room
from matstd.artefact.feasibility.room import mass_per_face as mass_per_face
from matstd.artefact.feasibility.room import room_among as room_among
from matstd.artefact.feasibility.standing import check_beside as check_beside
from matstd.artefact.feasibility.standing import check_seat as check_seat
from matstd.artefact.feasibility.standing import stands as stands
from matstd.artefact.feasibility.touched import in_the_way as in_the_way
from matstd.artefact.feasibility.touched import is_from_side as is_from_side
from matstd.artefact.feasibility.touched import mutually_probeable as mutually_probeable
from matstd.artefact.feasibility.touched import touches_on as touches_on
from matstd.artefact.feasibility.touched import untouchable_faces as untouchable_faces
