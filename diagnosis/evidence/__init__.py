"""Signatures of effects that are not in the model, and how much they explain.

In: a `Fit`, made a `ResidualSpace`, and candidate effects. Out: `Signatures`, their columns freed
of all that the model can imitate, and `EffectSet`, a set of them in the model, with its evidence,
its held-out errors and the scores of every further effect. Nothing is refitted.
"""

from matstd.diagnosis.evidence.detection import needed_lengths
from matstd.diagnosis.evidence.effect_signatures import (
    Grid,
    Progress,
    RawColumns,
    ResidualSpace,
    ScaledEffect,
    Signatures,
    blocks,
    projected,
    quiet,
    signatures,
    tuned_variants,
)
from matstd.diagnosis.evidence.evidence import (
    MIN_OWN_SHARE,
    EffectSet,
    Scores,
    addition,
    log_evidence,
    ranked,
    score_all,
    screen,
)
from matstd.diagnosis.evidence.periods import period_of, scanned_grids, strongest

__all__ = [
    "MIN_OWN_SHARE",
    "EffectSet",
    "Grid",
    "Progress",
    "RawColumns",
    "ResidualSpace",
    "ScaledEffect",
    "Scores",
    "Signatures",
    "addition",
    "blocks",
    "log_evidence",
    "needed_lengths",
    "period_of",
    "projected",
    "quiet",
    "ranked",
    "scanned_grids",
    "score_all",
    "screen",
    "signatures",
    "strongest",
    "tuned_variants",
]
