"""A standard against other artefacts, stylus lengths and set-ups."""

from artefact.compare.comparison import Rival, compare, evaluated, prior_rms, random_lots
from artefact.compare.identifiability import (
    Alone,
    IdentifiabilityReport,
    identifiability_report,
    write_identifiability,
)

__all__ = [
    "Alone",
    "IdentifiabilityReport",
    "Rival",
    "compare",
    "evaluated",
    "identifiability_report",
    "prior_rms",
    "random_lots",
    "write_identifiability",
]
