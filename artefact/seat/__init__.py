"""Whether a standard stands on its table and bodies are apart: outlines, hulls, common parts.

In: base, table and bodies in the frame of the table's face. Out: distances in mm.
"""

from matstd.artefact.seat.seating import (
    CONTACT_DEPTH,
    base_corners,
    common_part,
    middle_room,
    off_table,
    over_edge,
    over_table,
    overlap,
    same_place,
    seat_height,
)

__all__ = [
    "CONTACT_DEPTH",
    "base_corners",
    "common_part",
    "middle_room",
    "off_table",
    "over_edge",
    "over_table",
    "overlap",
    "same_place",
    "seat_height",
]
