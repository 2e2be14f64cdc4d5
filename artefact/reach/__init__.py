"""Which touches a machine can make on a standard."""

from artefact.reach.clearance import (
    TABLE_RADIUS,
    TABLE_THICKNESS,
    ProbeShape,
    clearance,
    clearance_on_table,
)
from artefact.reach.first_contact import contact
from artefact.reach.touchable import Mask, Probing, Requests, joined

__all__ = [
    "TABLE_RADIUS",
    "TABLE_THICKNESS",
    "Mask",
    "ProbeShape",
    "Probing",
    "Requests",
    "clearance",
    "clearance_on_table",
    "contact",
    "joined",
]
