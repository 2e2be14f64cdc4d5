"""A standard compared with other artefacts, stylus lengths and set-ups, at equal touches.

In: a criterion and the touches of a design. Out: the figures of every `Rival`, and what the
touches can and cannot determine (`IdentifiabilityReport`), with what would resolve the rest.
"""

from matstd.artefact.compare.alternatives import Alternative
from matstd.artefact.compare.comparison import (
    Compared,
    Rival,
    compared,
    evaluate_rival,
    prior_rms,
    random_lots,
)
from matstd.artefact.compare.identifiability import IdentifiabilityReport, identifiability_report
from matstd.artefact.compare.power import (
    DETECTION_POWER,
    FALSE_ALARM,
    MODEL_ERROR,
    Power,
    proof_power,
    task_normals,
)
from matstd.artefact.compare.regions import WorstRegions, worst_regions

__all__ = [
    "DETECTION_POWER",
    "FALSE_ALARM",
    "MODEL_ERROR",
    "Alternative",
    "Compared",
    "IdentifiabilityReport",
    "Power",
    "Rival",
    "WorstRegions",
    "compared",
    "evaluate_rival",
    "identifiability_report",
    "prior_rms",
    "proof_power",
    "random_lots",
    "task_normals",
    "worst_regions",
]
