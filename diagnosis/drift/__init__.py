"""Thermal drift from logs: laws that are judged by hours that they never saw.

In: logs of temperatures, speeds and displacements (`read_log`). Out: laws beside one another
(`judge`), each with what it leaves one step ahead, in blocks left out, and running freely in
held-out hours; the one that was `chosen` inside the training part, its uncertainty, and what
probing now and then makes of it (`predict_with_probings`). A saved law is an effect of a machine's
model (`DriftLaw`), which `LiveDrift` keeps right while the machine works. A new law is a module
with a function that fits it, and a line in `judged.offered`.
"""

from matstd.diagnosis.drift.clocks import lead
from matstd.diagnosis.drift.drift_file import read_law, write_drift, write_prediction
from matstd.diagnosis.drift.drift_law import DriftLaw, drift_law_of
from matstd.diagnosis.drift.judged import Judged, chosen, judge, offered
from matstd.diagnosis.drift.live import LiveDrift
from matstd.diagnosis.drift.log_file import check_alike, read_log, read_probed
from matstd.diagnosis.drift.probing import ProbedPrediction, predict_with_probings
from matstd.diagnosis.drift.record import DriftRecord, joined, varying

__all__ = [
    "DriftLaw",
    "DriftRecord",
    "Judged",
    "LiveDrift",
    "ProbedPrediction",
    "check_alike",
    "chosen",
    "drift_law_of",
    "joined",
    "judge",
    "lead",
    "offered",
    "predict_with_probings",
    "read_law",
    "read_log",
    "read_probed",
    "varying",
    "write_drift",
    "write_prediction",
]
