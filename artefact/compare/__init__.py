"""A standard against other artefacts, stylus lengths and set-ups."""

from artefact.compare.comparison import Rival, before, compare, judged, random_lots
from artefact.compare.identifiability import (
    Alone,
    IdentifiabilityReport,
    identifiability_report,
)

__all__ = [
    "Alone",
    "IdentifiabilityReport",
    "Rival",
    "before",
    "compare",
    "identifiability_report",
    "judged",
    "random_lots",
]
