"""Designs a standard: patches, their shapes, table poses and touches by information.

In: a `Brief`. Out: a `Placement`: the standard checked against every limit, its touches, their
criterion, its rivals, and a certificate.
"""

from matstd.artefact.place.body_choice import balls_beside as balls_beside
from matstd.artefact.place.family import CLEAR_LEAD as CLEAR_LEAD
from matstd.artefact.place.family import Family as Family
from matstd.artefact.place.family import FamilyFigures as FamilyFigures
from matstd.artefact.place.family import score_of as score_of
from matstd.artefact.place.identifying import left_unknown as left_unknown
from matstd.artefact.place.placement import Placement as Placement
from matstd.artefact.place.placement import design_standard as design_standard
from matstd.artefact.place.proving import proving_touches as proving_touches
from matstd.artefact.place.wavy_proof import showing_table_poses as showing_table_poses
