"""What a model leaves: patterns, regions, tests for structure."""

from diagnosis.residual.comparison import Comparison, GroupResidual, compare
from diagnosis.residual.failing_regions import Region, regions
from diagnosis.residual.partial_residuals import SEES, Partial, partial
from diagnosis.residual.patterns import directions, groups, variables
from diagnosis.residual.run_remarks import remarks
from diagnosis.residual.structure import Structure, find_structure

__all__ = [
    "SEES",
    "Comparison",
    "GroupResidual",
    "Partial",
    "Region",
    "Structure",
    "compare",
    "directions",
    "find_structure",
    "groups",
    "partial",
    "regions",
    "remarks",
    "variables",
]
