"""Designs a standard: patches, their shapes, table poses and touches by what they tell.

In: `ProbeReach`, `Blank`, workspace, population. Out: a `Placement`: the standard measured against
every limit, its touches, the criterion they were chosen by, its rivals, and a certificate.
"""

from matstd.artefact.place.options import PlacementOptions
from matstd.artefact.place.placement import Placement, design_standard
from matstd.artefact.place.room import Room, check_room, room_for

__all__ = ["Placement", "PlacementOptions", "Room", "check_room", "design_standard", "room_for"]
