"""What a user should know about a run besides the verdict: one record for each thing noticed.

In: a `Fit`. Out: `Remark`s, which carry numbers; `matstd.report.words` makes the sentences.
Something new to notice is a record here, and a function that makes it.
"""

from matstd.diagnosis.remarks.body_size import BodySize, body_sizes
from matstd.diagnosis.remarks.order import JumpInOrder
from matstd.diagnosis.remarks.other_run import EffectOfOtherRun
from matstd.diagnosis.remarks.run_remarks import (
    ChosenByPrediction,
    FewDegreesOfFreedom,
    FewPoses,
    FewTouches,
    FieldShares,
    HeldOutInDoubt,
    JointsStood,
    LoadTooSmall,
    ManyStoodOut,
    NoiseMisstated,
    NoiseRemembers,
    NotSignificant,
    OutliersKept,
    OutliersLeftOut,
    PriorWidened,
    ReaderRemark,
    Remark,
    SearchEnded,
    ShortBeam,
    WorseThanReplicates,
    remarks,
)
from matstd.diagnosis.remarks.turns import HarmonicsAlike

__all__ = [
    "BodySize",
    "ChosenByPrediction",
    "EffectOfOtherRun",
    "FewDegreesOfFreedom",
    "FewPoses",
    "FewTouches",
    "FieldShares",
    "HarmonicsAlike",
    "HeldOutInDoubt",
    "JointsStood",
    "JumpInOrder",
    "LoadTooSmall",
    "ManyStoodOut",
    "NoiseMisstated",
    "NoiseRemembers",
    "NotSignificant",
    "OutliersKept",
    "OutliersLeftOut",
    "PriorWidened",
    "ReaderRemark",
    "Remark",
    "SearchEnded",
    "ShortBeam",
    "WorseThanReplicates",
    "body_sizes",
    "remarks",
]
