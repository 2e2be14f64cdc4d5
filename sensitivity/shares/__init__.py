"""Which errors matter: total effects, and shares by region of the workspace."""

from sensitivity.shares.total_effect_indices import TotalEffects, norm_shares, total_effects
from sensitivity.shares.workspace_regions import (
    Region,
    RegionTotals,
    region_totals,
    region_words,
    regions,
)

__all__ = [
    "Region",
    "RegionTotals",
    "TotalEffects",
    "norm_shares",
    "region_totals",
    "region_words",
    "regions",
    "total_effects",
]
