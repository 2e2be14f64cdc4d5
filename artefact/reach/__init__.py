"""Which touches a machine can make on a standard: angle, travel, room for the probe, free ways.

In: machine, probe and set-up (`ProbeReach`), a standard, wanted touches (`Requests`). Out: masks of
those that can be made, the reason against each of the others, axis readings, and the touches as the
twin's effects understand them. A new hindrance is one more look in `ProbeReach`.
"""

from artefact.reach.face_of_table import table_face
from artefact.reach.probe_clearance import (
    TABLE_RADIUS,
    TABLE_THICKNESS,
    ProbeShape,
    clearance,
    clearance_on_table,
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

__all__ = [
    "ANGLE",
    "TABLE_RADIUS",
    "TABLE_THICKNESS",
    "Limit",
    "Mask",
    "PlacesInReach",
    "ProbeReach",
    "ProbeShape",
    "Requests",
    "clearance",
    "clearance_on_table",
    "joined",
    "places_on",
    "reach_of",
    "spread_poses",
    "table_face",
    "turned",
]
