"""What a model leaves: patterns, regions, tests for structure.

In: a `Fit` or an `EffectSet`. Out: the `Structure` and the `Region`s of its
residual and a `Remark` for everything noteworthy; `partial` is what the run shows of one effect.
A new test is a module beside `waves` and `crowds`, called by `structure`.
"""

from matstd.diagnosis.residual.boxes import Condition, Side
from matstd.diagnosis.residual.carriers import Bearer, apart_elsewhere, bearers
from matstd.diagnosis.residual.failing_regions import (
    Region,
    Wrong,
    observed_error,
    regions,
)
from matstd.diagnosis.residual.mean_displacements import has_poses, pose_vectors
from matstd.diagnosis.residual.partial_residuals import MIN_VIEW, Partial, Seen, partial
from matstd.diagnosis.residual.pattern_tests import PatternTests
from matstd.diagnosis.residual.patterns import directions, groups, variables
from matstd.diagnosis.residual.ranked_variables import (
    RankedVariable,
    binned,
    rank_variables,
    standardised,
)
from matstd.diagnosis.residual.structure import Shape, Structure, find_structure

__all__ = [
    "MIN_VIEW",
    "Bearer",
    "Condition",
    "Partial",
    "PatternTests",
    "RankedVariable",
    "Region",
    "Seen",
    "Shape",
    "Side",
    "Structure",
    "Wrong",
    "apart_elsewhere",
    "bearers",
    "binned",
    "directions",
    "find_structure",
    "groups",
    "has_poses",
    "observed_error",
    "partial",
    "pose_vectors",
    "rank_variables",
    "regions",
    "standardised",
    "variables",
]
