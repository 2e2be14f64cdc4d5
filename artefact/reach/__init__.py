"""Which touches a machine can make on a standard: angle, travel, room for the probe, free ways.

In: machine, probe and set-up (`ProbeReach`), a standard, wanted touches (`Requests`). Out: masks of
those that can be made, the reason against each of the others, axis readings, and the touches as the
twin's effects understand them. A new hindrance is one more look in `ProbeReach`.
"""

from artefact.reach.probe_clearance import (
    TABLE_RADIUS,
    TABLE_THICKNESS,
    ProbeShape,
    clearance,
    clearance_on_table,
)
from artefact.reach.touchable import Mask, ProbeReach, Requests, joined

__all__ = [
    "TABLE_RADIUS",
    "TABLE_THICKNESS",
    "Mask",
    "ProbeReach",
    "ProbeShape",
    "Requests",
    "clearance",
    "clearance_on_table",
    "joined",
]
