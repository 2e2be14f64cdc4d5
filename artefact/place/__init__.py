"""Designs a standard: patches, their shapes, table poses and touches by information.

In: a `Brief`. Out: a `Placement`: the standard checked against every limit, its touches, their
criterion, its rivals, and a certificate.
"""

from matstd.artefact.place.body_choice import balls_beside
from matstd.artefact.place.family import CLEAR_LEAD, Family, FamilyFigures, score_of
from matstd.artefact.place.identifying import left_unknown
from matstd.artefact.place.placement import Placement, design_standard
from matstd.artefact.place.proving import proving_touches
from matstd.artefact.place.wavy_proof import showing_table_poses

__all__ = [
    "CLEAR_LEAD",
    "Family",
    "FamilyFigures",
    "Placement",
    "balls_beside",
    "design_standard",
    "left_unknown",
    "proving_touches",
    "score_of",
    "showing_table_poses",
]
