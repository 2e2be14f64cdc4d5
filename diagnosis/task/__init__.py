"""What measurements of calibrated features say of a user's measuring task (ISO 15530-3).

In: runs of a standard on different days (`Visits`), a model or none, which touches are like the
task, and how well the features are calibrated. Out: a `TaskUncertainty`, the budget with its
expanded uncertainty, and what it leaves of a tolerance (`Guarded`).
"""

from matstd.diagnosis.task.decision import guarded as guarded
from matstd.diagnosis.task.uncertainty import LEVEL as LEVEL
from matstd.diagnosis.task.uncertainty import TaskUncertainty as TaskUncertainty
from matstd.diagnosis.task.uncertainty import task_uncertainty as task_uncertainty
from matstd.diagnosis.task.visits import Visits as Visits
from matstd.diagnosis.task.visits import visits_of as visits_of
