"""The answer of a diagnosis: verdict, sizes, what looks alike, what to measure next.

In: a run, a model, effects that a user adds. Out: a `Diagnosis`. `ambiguity` makes classes of
look-alikes, `sizes` numbers that rest on the touches alone, `detectable` what the run would have
shown, `next_measurement` touches that distinguish look-alikes, `proof` compares with a known truth.
"""

from matstd.diagnosis.answer.ambiguity import ConfusionClass as ConfusionClass
from matstd.diagnosis.answer.ambiguity import acts_as_instrument as acts_as_instrument
from matstd.diagnosis.answer.candidates import Candidate as Candidate
from matstd.diagnosis.answer.comparison import Comparison as Comparison
from matstd.diagnosis.answer.comparison import GroupResidual as GroupResidual
from matstd.diagnosis.answer.comparison import compare as compare
from matstd.diagnosis.answer.detectable import Detectable as Detectable
from matstd.diagnosis.answer.next_measurement import Plan as Plan
from matstd.diagnosis.answer.parts import Doubt as Doubt
from matstd.diagnosis.answer.parts import GeometryPart as GeometryPart
from matstd.diagnosis.answer.parts import NamedEffect as NamedEffect
from matstd.diagnosis.answer.parts import Remainder as Remainder
from matstd.diagnosis.answer.parts import VerdictParts as VerdictParts
from matstd.diagnosis.answer.run_diagnosis import diagnose as diagnose
from matstd.diagnosis.answer.steps import Step as Step
from matstd.diagnosis.answer.trend import RunErrors as RunErrors
from matstd.diagnosis.answer.trend import Trend as Trend
from matstd.diagnosis.answer.verdict import Diagnosis as Diagnosis
from matstd.diagnosis.answer.verdict import Verdict as Verdict
