"""The next visit to the machine: touches, order and times that decide between explanations.

In: laws that were learnt from a run, with their rivals. Out: `VisitPlan`: what to touch and when,
how far it separates every rival, and how often it would decide. `offers` has touches that can be
made, `course` what time and sensors do, `hypotheses` what every explanation predicts.
"""

from matstd.diagnosis.next_visit.course import Schedule as Schedule
from matstd.diagnosis.next_visit.discrimination import greedy as greedy
from matstd.diagnosis.next_visit.discrimination import separation as separation
from matstd.diagnosis.next_visit.hypotheses import DECIDED as DECIDED
from matstd.diagnosis.next_visit.offers import candidate_targets as candidate_targets
from matstd.diagnosis.next_visit.offers import candidate_touches as candidate_touches
from matstd.diagnosis.next_visit.offers import visiting_touches as visiting_touches
from matstd.diagnosis.next_visit.planned_visit import LEAST_SEPARATION as LEAST_SEPARATION
from matstd.diagnosis.next_visit.planned_visit import NoPlan as NoPlan
from matstd.diagnosis.next_visit.planned_visit import RivalPower as RivalPower
from matstd.diagnosis.next_visit.planned_visit import VisitPlan as VisitPlan
from matstd.diagnosis.next_visit.planned_visit import plan_visit as plan_visit
