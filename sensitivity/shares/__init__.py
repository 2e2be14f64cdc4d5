"""Which errors matter: total effects on a length, and shares by region of the workspace.

A population and poses go in; out come the share of every error in the variance of the deviation,
exact to first order, and its total effect on the length |d|, by simulation.
"""

from matstd.sensitivity.shares.total_effect_indices import TotalEffects, norm_shares, total_effects
from matstd.sensitivity.shares.workspace_regions import (
    Part,
    Place,
    Region,
    RegionTotals,
    region_totals,
    regions,
)

__all__ = [
    "Part", "Place", "Region", "RegionTotals", "TotalEffects", "norm_shares", "region_totals",
    "regions", "total_effects",
]  # fmt: skip
