"""Which touches a machine can make on a standard: angle, travel, room for the probe, free ways.

In: machine, probe and set-up (`ProbeReach`), a standard, wanted touches (`Requests`). Out: masks of
those that can be made, the reason against each of the others, axis readings, and the touches as the
twin's effects understand them. A new hindrance is one more look in `ProbeReach`; a body beside the
standard is a `Solid` of the `Workshop`.
"""

from matstd.artefact.reach.bodies import Body, Clamping
from matstd.artefact.reach.datum_ball import DatumBall
from matstd.artefact.reach.face_of_table import hangs, standing_remarks, table_face
from matstd.artefact.reach.mesh_cover import mesh_triangles, read_drawn_body
from matstd.artefact.reach.probe_clearance import ProbeShape, clearance
from matstd.artefact.reach.touchable import TRAVEL_ROUNDING, ProbeReach, Requests, joined
from matstd.artefact.reach.within_reach import (
    ANGLE,
    Limit,
    PlacesInReach,
    places_on,
    reach_of,
    spread_poses,
)
from matstd.artefact.reach.workshop import (
    TABLE,
    TABLE_RADIUS,
    Solid,
    Workshop,
    round_table,
    still_frames,
)

__all__ = [
    "ANGLE",
    "TABLE",
    "TABLE_RADIUS",
    "TRAVEL_ROUNDING",
    "Body",
    "Clamping",
    "DatumBall",
    "Limit",
    "PlacesInReach",
    "ProbeReach",
    "ProbeShape",
    "Requests",
    "Solid",
    "Workshop",
    "clearance",
    "hangs",
    "joined",
    "mesh_triangles",
    "places_on",
    "reach_of",
    "read_drawn_body",
    "round_table",
    "spread_poses",
    "standing_remarks",
    "still_frames",
    "table_face",
]
