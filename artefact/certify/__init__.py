"""What a calibration makes of a standard, and which of its touches are like a user's task.

In: a `Standard`; points that a coordinate measuring machine took on it, touches of a run, a task.
Out: the standard as it is, with its uncertainties (`calibrated`), and whether it conforms to its
drawing (`judged`); the program that takes the points (`dmis_program`); the touches that prove a
task; standards that differ from their calibration as much as it allows.
"""

from matstd.artefact.certify.calibration_fit import Calibrated, calibrated
from matstd.artefact.certify.cmm_points_file import read_cmm_points
from matstd.artefact.certify.dmis import dmis_program
from matstd.artefact.certify.task_places import check_places, like_task, on_faces
from matstd.artefact.certify.true_places import misplaced
from matstd.artefact.certify.verdicts import Allowed, CommonCause, judged

__all__ = [
    "Allowed",
    "Calibrated",
    "CommonCause",
    "calibrated",
    "check_places",
    "dmis_program",
    "judged",
    "like_task",
    "misplaced",
    "on_faces",
    "read_cmm_points",
]
