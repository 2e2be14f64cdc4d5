"""What touches can and cannot separate.

Whitened rows of touches go in; out come rank, condition, gauge freedoms with what would resolve
them, combinations that are determined, parameters that are tied, degrees that are supported. All of
it is data; `report.words` puts it into words.
"""

from information.identifiability.correlation import STRONG, Pair, Ties, ties
from information.identifiability.degrees import Degree, supported_degrees
from information.identifiability.estimable_combinations import EstimableCombination, combinations
from information.identifiability.freedoms import (
    Freedom,
    FreedomFamily,
    Reason,
    Resolution,
    Term,
    in_families,
)
from information.identifiability.nullspace import rank_analysis
from information.identifiability.separation import Group, Identifiability, identifiability

__all__ = [
    "STRONG",
    "Degree",
    "EstimableCombination",
    "Freedom",
    "FreedomFamily",
    "Group",
    "Identifiability",
    "Pair",
    "Reason",
    "Resolution",
    "Term",
    "Ties",
    "combinations",
    "identifiability",
    "in_families",
    "rank_analysis",
    "supported_degrees",
    "ties",
]
