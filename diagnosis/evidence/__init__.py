"""Signatures of effects that are not in the model, and how much they explain."""

from diagnosis.evidence.evidence import (
    EffectSet,
    Scores,
    addition,
    f_probability,
    reduced,
    score_all,
    screen,
)
from diagnosis.evidence.signatures import (
    Complement,
    Grid,
    Progress,
    Signatures,
    Sized,
    blocks,
    projected,
    quiet,
    signatures,
    whole_grids,
)

__all__ = [
    "Complement",
    "EffectSet",
    "Grid",
    "Progress",
    "Scores",
    "Signatures",
    "Sized",
    "addition",
    "blocks",
    "f_probability",
    "projected",
    "quiet",
    "reduced",
    "score_all",
    "screen",
    "signatures",
    "whole_grids",
]
