"""What was measured: touches, set-ups and runs, as arrays.

`Touches` is the one record that flows through the house: everything known about N contacts, base
units. A new quantity that is recorded at every touch becomes a field of it; `Run` adds deviations.
"""

from matstd.twin.record.alignment import Moved, aligned, rigid_motion, turn_of
from matstd.twin.record.body import BODY, U_SHARE, StatedBody, with_body
from matstd.twin.record.commanded import with_commanded
from matstd.twin.record.copies import without_copies
from matstd.twin.record.instrument import Instrument
from matstd.twin.record.run import Run
from matstd.twin.record.several_runs import joined, stacked
from matstd.twin.record.touches import (
    Body,
    Labels,
    Setup,
    Touches,
    at_poses,
    computed_deviation,
    implied_approach,
    last_signs,
    linear_approach,
)

__all__ = [
    "BODY", "U_SHARE", "Body", "Instrument", "Labels", "Moved", "Run", "Setup",
    "StatedBody", "Touches", "aligned", "at_poses", "computed_deviation", "implied_approach",
    "joined", "last_signs", "linear_approach", "rigid_motion", "stacked", "turn_of", "with_body",
    "with_commanded", "without_copies",
]  # fmt: skip
