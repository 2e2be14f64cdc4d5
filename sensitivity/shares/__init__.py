"""Which errors matter: total effects, and shares by region of the workspace."""

from sensitivity.shares.regions import Region, RegionTotals, region_totals, region_words, regions
from sensitivity.shares.total_effects import TotalEffects, norm_shares, total_effects

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
