"""What touches can and cannot separate.

Whitened rows of touches go in; out come rank, condition, gauge freedoms with what would resolve
them, combinations that are determined, parameters that are tied, degrees that are supported. All of
it is data; `matstd.report.words` puts it into words.
"""

from matstd.information.identifiability.correlation import STRONG_CORRELATION, Pair, Ties, ties
from matstd.information.identifiability.degrees import Degree, supported_degrees
from matstd.information.identifiability.estimable_combinations import (
    EstimableCombination,
    combinations,
)
from matstd.information.identifiability.freedoms import (
    Freedom,
    FreedomFamily,
    Resolution,
    Term,
    in_families,
)
from matstd.information.identifiability.nullspace import rank_analysis
from matstd.information.identifiability.separation import Identifiability, identifiability

__all__ = [
    "STRONG_CORRELATION", "Degree", "EstimableCombination", "Freedom", "FreedomFamily",
    "Identifiability", "Pair", "Resolution", "Term", "Ties", "combinations", "identifiability",
    "in_families", "rank_analysis", "supported_degrees", "ties",
]  # fmt: skip
