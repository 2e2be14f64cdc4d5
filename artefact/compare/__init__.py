"""A standard against other artefacts, stylus lengths and set-ups."""

from artefact.compare.comparison import Rival, before, compare, judged, random_lots
from artefact.compare.knowable import Alone, Knowable, knowable, write_identifiability

__all__ = [
    "Alone",
    "Knowable",
    "Rival",
    "before",
    "compare",
    "judged",
    "knowable",
    "random_lots",
    "write_identifiability",
]
