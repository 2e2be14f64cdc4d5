"""The answer of a diagnosis: verdict, sizes, what looks alike, what to measure next."""

from diagnosis.answer.ambiguity import CONFUSED, ConfusionClass
from diagnosis.answer.detectable import Detectable
from diagnosis.answer.next_measurement import Plan
from diagnosis.answer.proof import Proof, probed_volume, prove
from diagnosis.answer.run_diagnosis import diagnose
from diagnosis.answer.verdict import Candidate, Diagnosis, Step, Verdict

__all__ = [
    "CONFUSED",
    "Candidate",
    "ConfusionClass",
    "Detectable",
    "Diagnosis",
    "Plan",
    "Proof",
    "Step",
    "Verdict",
    "diagnose",
    "probed_volume",
    "prove",
]
