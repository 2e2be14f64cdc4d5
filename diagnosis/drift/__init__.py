"""Thermal drift from logs: laws that are judged by hours that they never saw.

In: logs of temperatures, speeds and displacements (`read_log`). Out: laws beside one another
(`judge`), each with what it leaves one step ahead, in blocks left out, and running freely in
held-out hours; the one that was `chosen` inside the training part, its uncertainty, and what
probing now and then makes of it (`predict_with_probings`). A saved law is an effect of a machine's
model (`DriftLaw`), which `LiveDrift` keeps right while the machine works. A new law is a module
with a function that fits it, and a line in `judged.offered`.
"""

from matstd.diagnosis.drift.drift_file import read_law as read_law
from matstd.diagnosis.drift.drift_file import write_drift as write_drift
from matstd.diagnosis.drift.drift_file import write_prediction as write_prediction
from matstd.diagnosis.drift.drift_law import drift_law_of as drift_law_of
from matstd.diagnosis.drift.judged import Judged as Judged
from matstd.diagnosis.drift.judged import JudgedLaws as JudgedLaws
from matstd.diagnosis.drift.judged import chosen as chosen
from matstd.diagnosis.drift.judged import judge as judge
from matstd.diagnosis.drift.judged import offered as offered
from matstd.diagnosis.drift.lags import lead as lead
from matstd.diagnosis.drift.live import LiveDrift as LiveDrift
from matstd.diagnosis.drift.log_file import check_alike as check_alike
from matstd.diagnosis.drift.log_file import read_log as read_log
from matstd.diagnosis.drift.log_file import read_probed as read_probed
from matstd.diagnosis.drift.probing import ProbedPrediction as ProbedPrediction
from matstd.diagnosis.drift.probing import predict_with_probings as predict_with_probings
from matstd.diagnosis.drift.record import DriftRecord as DriftRecord
from matstd.diagnosis.drift.record import joined as joined
from matstd.diagnosis.drift.record import varying as varying
