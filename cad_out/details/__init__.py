"""What a workshop adds to the body, by rule from the standard alone and without the CAD kernel.

In: a `Standard`. Out: its `Details`: seats of the balls, pads and screws, datum sides, lifting
holes, thermometer pocket, lettering. The kernel builds them, the drawing shows them, the report on
makeability measures them.
"""

from matstd.cad_out.details.annotations import annotations_of as annotations_of
from matstd.cad_out.details.detail_list import Details as Details
from matstd.cad_out.details.detail_list import details_of as details_of
from matstd.cad_out.details.detail_list import engraved_on as engraved_on
from matstd.cad_out.details.dot_font import CUTTER as CUTTER
from matstd.cad_out.details.dot_font import DEPTH as DEPTH
from matstd.cad_out.details.dot_font import DOT as DOT
from matstd.cad_out.details.lettering import Lettering as Lettering
from matstd.cad_out.details.mounting import BALL as BALL
from matstd.cad_out.details.mounting import RELIEF as RELIEF
from matstd.cad_out.details.mounting import SCREW as SCREW
from matstd.cad_out.details.mounting import Pad as Pad
from matstd.cad_out.details.mounting import Screw as Screw
from matstd.cad_out.details.mounting import relief_profile as relief_profile
from matstd.cad_out.details.places import Bore as Bore
from matstd.cad_out.details.places import Side as Side
from matstd.cad_out.details.places import datum_touches as datum_touches
from matstd.cad_out.details.seats import Seat as Seat
from matstd.cad_out.details.seats import glue_gap as glue_gap
from matstd.cad_out.details.tolerances import BALL_SIZE as BALL_SIZE
from matstd.cad_out.details.tolerances import CALIBRATED as CALIBRATED
from matstd.cad_out.details.tolerances import DATUMS as DATUMS
from matstd.cad_out.details.tolerances import Tolerance as Tolerance
from matstd.cad_out.details.tolerances import notes_of as notes_of
from matstd.cad_out.details.tolerances import tolerances_of as tolerances_of
from matstd.cad_out.details.tolerances import widths as widths
