"""The geometry that a fit has learnt, as a machine's user speaks of it: numbers, no sentences.

In: a `Fit` of the ordinary model. Out: a `LearntGeometry`: squareness, scale, straightness, angular
errors and lines of the rotary axes with uncertainty, what they do at the ends of the travel, what
changed since a saved model, corrections of the machine file, and the ladder from the set-up alone.
"""

from matstd.diagnosis.geometry.arm_machine import found_arm
from matstd.diagnosis.geometry.changes import (
    changed_since,
    changing,
    standing,
    state_of_standing,
    with_changes,
)
from matstd.diagnosis.geometry.corrections import Correction, key_of
from matstd.diagnosis.geometry.learnt import (
    LearntGeometry,
    Rung,
    changed_runs,
    geometry_rows,
    learnt_geometry,
)
from matstd.diagnosis.geometry.quantities import Quantity
from matstd.diagnosis.geometry.rivals import SETUP_FACTOR, FoundNumber
from matstd.diagnosis.geometry.rows import (
    Estimate,
    GeometryRow,
)

__all__ = [
    "SETUP_FACTOR",
    "Correction",
    "Estimate",
    "FoundNumber",
    "GeometryRow",
    "LearntGeometry",
    "Quantity",
    "Rung",
    "changed_runs",
    "changed_since",
    "changing",
    "found_arm",
    "geometry_rows",
    "key_of",
    "learnt_geometry",
    "standing",
    "state_of_standing",
    "with_changes",
]
