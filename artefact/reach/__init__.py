"""Which touches a machine can make on a standard."""

from artefact.reach.first_contact import contact
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
    "contact",
    "joined",
]
