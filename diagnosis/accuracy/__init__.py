"""How well a run repeats itself, and how well a model of it will predict.

In: a `Fit`. Out: `Repeatability`, the scatter of repeated touches beside the stated noise, and a
`Promise`, the errors to expect at the same touches and at other places. `compare` and `diagnose`
both ask here. Of a machine whose truth is known, a `Proof`: what a model predicts of it.
"""

from matstd.diagnosis.accuracy.left_out_blocks import blocks, domains
from matstd.diagnosis.accuracy.promised import (
    Domain,
    Promise,
    machine_variance,
    other_places,
    promise,
)
from matstd.diagnosis.accuracy.proof import Proof, probed_volume, prove, seen_from
from matstd.diagnosis.accuracy.repeats import Repeatability, Scatter, repeatability

__all__ = [
    "Domain",
    "Promise",
    "Proof",
    "Repeatability",
    "Scatter",
    "blocks",
    "domains",
    "machine_variance",
    "other_places",
    "probed_volume",
    "promise",
    "prove",
    "repeatability",
    "seen_from",
]
