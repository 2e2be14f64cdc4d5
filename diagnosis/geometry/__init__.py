"""The geometry that a fit has learnt, as a machine's user speaks of it: numbers, no sentences.

In: a `Fit` of the ordinary model. Out: a `LearntGeometry`: squareness, scale, straightness, angular
errors and lines of the rotary axes with uncertainty, what they do at the ends of the travel, what
changed since a saved model, corrections of the machine file, and the ladder from the set-up alone.
"""

from matstd.diagnosis.geometry.arm_machine import found_arm as found_arm
from matstd.diagnosis.geometry.changes import changed_since as changed_since
from matstd.diagnosis.geometry.changes import changing as changing
from matstd.diagnosis.geometry.changes import standing as standing
from matstd.diagnosis.geometry.changes import state_of_standing as state_of_standing
from matstd.diagnosis.geometry.changes import with_changes as with_changes
from matstd.diagnosis.geometry.corrections import Correction as Correction
from matstd.diagnosis.geometry.corrections import key_of as key_of
from matstd.diagnosis.geometry.corrections import moved_point as moved_point
from matstd.diagnosis.geometry.corrections import turned_direction as turned_direction
from matstd.diagnosis.geometry.learnt import LearntGeometry as LearntGeometry
from matstd.diagnosis.geometry.learnt import Rung as Rung
from matstd.diagnosis.geometry.learnt import changed_runs as changed_runs
from matstd.diagnosis.geometry.learnt import geometry_rows as geometry_rows
from matstd.diagnosis.geometry.learnt import learnt_geometry as learnt_geometry
from matstd.diagnosis.geometry.quantities import Quantity as Quantity
from matstd.diagnosis.geometry.rivals import SETUP_FACTOR as SETUP_FACTOR
from matstd.diagnosis.geometry.rivals import FoundNumber as FoundNumber
from matstd.diagnosis.geometry.rows import Estimate as Estimate
from matstd.diagnosis.geometry.rows import GeometryRow as GeometryRow
