"""What a user should know about a run besides the verdict: one record for each thing noticed.

In: a `Fit`. Out: `Remark`s, which carry numbers; `matstd.report.words` makes the sentences.
Something new to notice is a member of `What`, and a line in `run_remarks` that makes it.
"""

from matstd.diagnosis.remarks.body_size import BodySize as BodySize
from matstd.diagnosis.remarks.body_size import body_sizes as body_sizes
from matstd.diagnosis.remarks.offsets import OffTogether as OffTogether
from matstd.diagnosis.remarks.offsets import off_together as off_together
from matstd.diagnosis.remarks.order import JumpInOrder as JumpInOrder
from matstd.diagnosis.remarks.remark_kinds import Noticed as Noticed
from matstd.diagnosis.remarks.remark_kinds import What as What
from matstd.diagnosis.remarks.remark_kinds import noticed as noticed
from matstd.diagnosis.remarks.remark_kinds import short_beam as short_beam
from matstd.diagnosis.remarks.run_remarks import EffectOfOtherRun as EffectOfOtherRun
from matstd.diagnosis.remarks.run_remarks import HarmonicsAlike as HarmonicsAlike
from matstd.diagnosis.remarks.run_remarks import Remark as Remark
from matstd.diagnosis.remarks.run_remarks import remarks as remarks
