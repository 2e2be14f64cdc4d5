"""What a calibration makes of a standard, and which of its touches are like a user's task.

In: a `Standard`; points that a coordinate measuring machine took on it, touches of a run, a task.
Out: the standard as measured, with its uncertainties (`fit_calibration`), and its conformity with
the drawing (`with_verdicts`); the program that takes the points (`dmis_program`); the touches that
prove a task; standards that differ from their calibration within its uncertainties.
"""

from matstd.artefact.certify.calibration_fit import CalibrationFit as CalibrationFit
from matstd.artefact.certify.calibration_fit import fit_calibration as fit_calibration
from matstd.artefact.certify.cmm_points_file import read_cmm_points as read_cmm_points
from matstd.artefact.certify.dmis import dmis_program as dmis_program
from matstd.artefact.certify.reversal import merged_orientations as merged_orientations
from matstd.artefact.certify.task_places import check_places as check_places
from matstd.artefact.certify.task_places import farthest_off as farthest_off
from matstd.artefact.certify.task_places import like_task as like_task
from matstd.artefact.certify.task_places import that_prove as that_prove
from matstd.artefact.certify.true_places import displaced_features as displaced_features
from matstd.artefact.certify.verdicts import Allowed as Allowed
from matstd.artefact.certify.verdicts import CommonCause as CommonCause
from matstd.artefact.certify.verdicts import with_verdicts as with_verdicts
from matstd.artefact.certify.waviness import MAX_SPACING as MAX_SPACING
