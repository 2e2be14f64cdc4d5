"""Which touches a machine can make on a standard: angle, travel, room for the probe, free ways.

In: machine, probe and set-up (`ProbeReach`), a standard, wanted touches (`Requests`). Out: masks of
those that can be made, the reason against each of the others, axis readings, and the touches as the
twin's effects understand them. A new hindrance is one more look in `ProbeReach`; a body beside the
standard is a `Solid` of the `Workshop`.
"""

from artefact.reach.datum_ball import DatumBall
from artefact.reach.face_of_table import hangs, seat_height, standing_remarks, table_face
from artefact.reach.mesh_cover import closed_mesh, covering_solids
from artefact.reach.probe_clearance import ProbeShape, clearance
from artefact.reach.seating import (
    TOUCHING,
    base_corners,
    common_part,
    middle_room,
    off_table,
    over_edge,
    overlap,
)
from artefact.reach.touchable import Mask, ProbeReach, Requests, joined
from artefact.reach.within_reach import (
    ANGLE,
    Limit,
    PlacesInReach,
    places_on,
    reach_of,
    spread_poses,
    turned,
)
from artefact.reach.workshop import (
    TABLE,
    Solid,
    Workshop,
    clearance_in_workshop,
    round_table,
    still_frames,
)

__all__ = [
    "ANGLE",
    "TABLE",
    "TOUCHING",
    "DatumBall",
    "Limit",
    "Mask",
    "PlacesInReach",
    "ProbeReach",
    "ProbeShape",
    "Requests",
    "Solid",
    "Workshop",
    "base_corners",
    "clearance",
    "clearance_in_workshop",
    "closed_mesh",
    "common_part",
    "covering_solids",
    "hangs",
    "joined",
    "middle_room",
    "off_table",
    "over_edge",
    "overlap",
    "places_on",
    "reach_of",
    "round_table",
    "seat_height",
    "spread_poses",
    "standing_remarks",
    "still_frames",
    "table_face",
    "turned",
]
