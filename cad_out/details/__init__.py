"""What a workshop adds to the body, by rule from the standard alone and without the CAD kernel.

In: a `Standard`. Out: its `Details`: seats of the balls, pads and screws, datum sides, lifting
holes, thermometer pocket, lettering. The kernel builds them, the drawing shows them, the report on
makeability measures them.
"""

from matstd.cad_out.details.annotations import annotations_of
from matstd.cad_out.details.detail_list import Details, details_of, engraved_on
from matstd.cad_out.details.dot_font import CUTTER, DEPTH, DOT
from matstd.cad_out.details.lettering import Lettering
from matstd.cad_out.details.mounting import BALL, RELIEF, SCREW, Pad, Screw, relief_profile
from matstd.cad_out.details.places import Bore, Side, datum_touches
from matstd.cad_out.details.seats import Seat, glue_gap
from matstd.cad_out.details.tolerances import (
    BALL_SIZE,
    CALIBRATED,
    DATUMS,
    Tolerance,
    notes_of,
    tolerances_of,
    widths,
)

__all__ = [
    "BALL",
    "BALL_SIZE",
    "CALIBRATED",
    "CUTTER",
    "DATUMS",
    "DEPTH",
    "DOT",
    "RELIEF",
    "SCREW",
    "Bore",
    "Details",
    "Lettering",
    "Pad",
    "Screw",
    "Seat",
    "Side",
    "Tolerance",
    "annotations_of",
    "datum_touches",
    "details_of",
    "engraved_on",
    "glue_gap",
    "notes_of",
    "relief_profile",
    "tolerances_of",
    "widths",
]
