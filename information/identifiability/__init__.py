"""What touches can and cannot separate.

Whitened rows of touches go in; out come rank, condition, gauge freedoms with what would resolve
them, combinations that are determined, parameters that are tied, degrees that are supported. All of
it is data; `matstd.report.words` puts it into words.
"""

from matstd.information.identifiability.correlation import STRONG_CORRELATION as STRONG_CORRELATION
from matstd.information.identifiability.correlation import Pair as Pair
from matstd.information.identifiability.correlation import Ties as Ties
from matstd.information.identifiability.correlation import ties as ties
from matstd.information.identifiability.degrees import Degree as Degree
from matstd.information.identifiability.degrees import supported_degrees as supported_degrees
from matstd.information.identifiability.estimable_combinations import (
    EstimableCombination as EstimableCombination,
)
from matstd.information.identifiability.estimable_combinations import combinations as combinations
from matstd.information.identifiability.freedoms import Freedom as Freedom
from matstd.information.identifiability.freedoms import FreedomFamily as FreedomFamily
from matstd.information.identifiability.freedoms import Resolution as Resolution
from matstd.information.identifiability.freedoms import Term as Term
from matstd.information.identifiability.freedoms import in_families as in_families
from matstd.information.identifiability.nullspace import column_lengths as column_lengths
from matstd.information.identifiability.nullspace import rank_analysis as rank_analysis
from matstd.information.identifiability.separation import Identifiability as Identifiability
from matstd.information.identifiability.separation import identifiability as identifiability
