"""What a user should know about a run besides the verdict: one record for each thing noticed.

In: a `Fit`. Out: `Remark`s, which carry numbers; `matstd.report.words` makes the sentences.
Something new to notice is a member of `What`, and a line in `run_remarks` that makes it.
"""

from matstd.diagnosis.remarks.body_size import BodySize, body_sizes
from matstd.diagnosis.remarks.order import JumpInOrder
from matstd.diagnosis.remarks.other_run import EffectOfOtherRun
from matstd.diagnosis.remarks.remark_kinds import Noticed, What, noticed, short_beam
from matstd.diagnosis.remarks.run_remarks import Remark, remarks
from matstd.diagnosis.remarks.turns import HarmonicsAlike

__all__ = [
    "BodySize",
    "EffectOfOtherRun",
    "HarmonicsAlike",
    "JumpInOrder",
    "Noticed",
    "Remark",
    "What",
    "body_sizes",
    "noticed",
    "remarks",
    "short_beam",
]
