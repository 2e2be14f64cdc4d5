"""The next visit to the machine: touches, order and times that decide between explanations.

In: laws that were learnt from a run, with their rivals. Out: `VisitPlan`: what to touch and when,
how far it separates every rival, and how often it would decide. `offers` has touches that can be
made, `course` what time and sensors do, `hypotheses` what every explanation predicts.
"""

from matstd.diagnosis.next_visit.course import Schedule
from matstd.diagnosis.next_visit.discrimination import greedy, separation
from matstd.diagnosis.next_visit.hypotheses import DECIDED
from matstd.diagnosis.next_visit.offers import candidate_targets, candidate_touches
from matstd.diagnosis.next_visit.planned_visit import NoPlan, RivalPower, VisitPlan, plan_visit

__all__ = [
    "DECIDED",
    "NoPlan",
    "RivalPower",
    "Schedule",
    "VisitPlan",
    "candidate_targets",
    "candidate_touches",
    "greedy",
    "plan_visit",
    "separation",
]
