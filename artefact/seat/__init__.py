"""Whether a standard stands on its table and bodies are apart: outlines, hulls, common parts.

In: base, table and bodies in the frame of the table's face. Out: distances in mm.
"""

from matstd.artefact.seat.seating import CONTACT_DEPTH as CONTACT_DEPTH
from matstd.artefact.seat.seating import base_corners as base_corners
from matstd.artefact.seat.seating import common_part as common_part
from matstd.artefact.seat.seating import manifold as manifold
from matstd.artefact.seat.seating import middle_room as middle_room
from matstd.artefact.seat.seating import off_table as off_table
from matstd.artefact.seat.seating import over_edge as over_edge
from matstd.artefact.seat.seating import over_table as over_table
from matstd.artefact.seat.seating import overlap as overlap
from matstd.artefact.seat.seating import same_place as same_place
from matstd.artefact.seat.seating import seat_height as seat_height
