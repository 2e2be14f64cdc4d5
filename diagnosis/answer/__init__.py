"""The answer of a diagnosis: verdict, sizes, what looks alike, what to measure next.

In: a run, a model, effects that a user adds. Out: a `Diagnosis`. `ambiguity` makes classes of
look-alikes, `sizes` numbers that rest on the touches alone, `detectable` what the run would have
shown, `next_measurement` touches that distinguish look-alikes, `proof` compares with a known truth.
"""

from matstd.diagnosis.answer.ambiguity import ConfusionClass
from matstd.diagnosis.answer.candidates import Candidate
from matstd.diagnosis.answer.comparison import Comparison, GroupResidual, compare
from matstd.diagnosis.answer.detectable import Detectable
from matstd.diagnosis.answer.next_measurement import Plan
from matstd.diagnosis.answer.parts import (
    GeometryPart,
    NamedEffect,
    Remainder,
    VerdictParts,
)
from matstd.diagnosis.answer.run_diagnosis import diagnose
from matstd.diagnosis.answer.steps import Step
from matstd.diagnosis.answer.trend import RunErrors, Trend
from matstd.diagnosis.answer.verdict import Diagnosis, Verdict

__all__ = [
    "Candidate",
    "Comparison",
    "ConfusionClass",
    "Detectable",
    "Diagnosis",
    "GeometryPart",
    "GroupResidual",
    "NamedEffect",
    "Plan",
    "Remainder",
    "RunErrors",
    "Step",
    "Trend",
    "Verdict",
    "VerdictParts",
    "compare",
    "diagnose",
]
