"""Signatures of effects that are not in the model, and how much they explain.

In: a `Fit`, made a `ResidualSpace`, and candidate effects. Out: `Signatures`, their columns freed
of all that the model can imitate, and `EffectSet`, a set of them in the model, with its evidence,
its held-out errors and the scores of every further effect. Nothing is refitted.
"""

from matstd.diagnosis.evidence.detection import needed_lengths as needed_lengths
from matstd.diagnosis.evidence.effect_signatures import Grid as Grid
from matstd.diagnosis.evidence.effect_signatures import Progress as Progress
from matstd.diagnosis.evidence.effect_signatures import RawColumns as RawColumns
from matstd.diagnosis.evidence.effect_signatures import ResidualSpace as ResidualSpace
from matstd.diagnosis.evidence.effect_signatures import ScaledEffect as ScaledEffect
from matstd.diagnosis.evidence.effect_signatures import Signatures as Signatures
from matstd.diagnosis.evidence.effect_signatures import blocks as blocks
from matstd.diagnosis.evidence.effect_signatures import projected as projected
from matstd.diagnosis.evidence.effect_signatures import quiet as quiet
from matstd.diagnosis.evidence.effect_signatures import signatures as signatures
from matstd.diagnosis.evidence.effect_signatures import tuned_variants as tuned_variants
from matstd.diagnosis.evidence.evidence import MIN_OWN_SHARE as MIN_OWN_SHARE
from matstd.diagnosis.evidence.evidence import EffectSet as EffectSet
from matstd.diagnosis.evidence.evidence import Scores as Scores
from matstd.diagnosis.evidence.evidence import addition as addition
from matstd.diagnosis.evidence.evidence import log_evidence as log_evidence
from matstd.diagnosis.evidence.evidence import ranked as ranked
from matstd.diagnosis.evidence.evidence import score_all as score_all
from matstd.diagnosis.evidence.evidence import screen as screen
from matstd.diagnosis.evidence.periods import period_of as period_of
from matstd.diagnosis.evidence.periods import scanned_grids as scanned_grids
from matstd.diagnosis.evidence.periods import strongest as strongest
