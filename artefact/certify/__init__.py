"""What a calibration makes of a standard, and which of its touches are like a user's task.

In: a `Standard`; points that a coordinate measuring machine took on it, touches of a run, a task.
Out: the standard as measured, with its uncertainties (`fit_calibration`), and its conformity with
the drawing (`with_verdicts`); the program that takes the points (`dmis_program`); the touches that
prove a task; standards that differ from their calibration within its uncertainties.
"""

from matstd.artefact.certify.calibration_fit import CalibrationFit, fit_calibration
from matstd.artefact.certify.cmm_points_file import read_cmm_points
from matstd.artefact.certify.dmis import dmis_program
from matstd.artefact.certify.reversal import merged_orientations
from matstd.artefact.certify.task_places import check_places, farthest_off, like_task, that_prove
from matstd.artefact.certify.true_places import displaced_features
from matstd.artefact.certify.verdicts import Allowed, CommonCause, with_verdicts
from matstd.artefact.certify.waviness import MAX_SPACING

__all__ = [
    "MAX_SPACING",
    "Allowed",
    "CalibrationFit",
    "CommonCause",
    "check_places",
    "displaced_features",
    "dmis_program",
    "farthest_off",
    "fit_calibration",
    "like_task",
    "merged_orientations",
    "read_cmm_points",
    "that_prove",
    "with_verdicts",
]
