"""How well a run repeats itself, and how well a model of it will predict.

In: a `Fit`. Out: `Repeatability`, the scatter of repeated touches beside the stated noise, and a
`Promise`, the errors to expect at the same touches and at other places. `compare` and `diagnose`
both ask here. Of a machine whose truth is known, a `Proof`: what a model predicts of it.
"""

from matstd.diagnosis.accuracy.left_out_blocks import blocks as blocks
from matstd.diagnosis.accuracy.left_out_blocks import domains as domains
from matstd.diagnosis.accuracy.promised import Promise as Promise
from matstd.diagnosis.accuracy.promised import machine_root as machine_root
from matstd.diagnosis.accuracy.promised import machine_variance as machine_variance
from matstd.diagnosis.accuracy.promised import other_places as other_places
from matstd.diagnosis.accuracy.promised import promise as promise
from matstd.diagnosis.accuracy.proof import Proof as Proof
from matstd.diagnosis.accuracy.proof import probed_volume as probed_volume
from matstd.diagnosis.accuracy.proof import prove as prove
from matstd.diagnosis.accuracy.proof import seen_from as seen_from
from matstd.diagnosis.accuracy.repeats import Repeatability as Repeatability
from matstd.diagnosis.accuracy.repeats import Scatter as Scatter
from matstd.diagnosis.accuracy.repeats import repeatability as repeatability
