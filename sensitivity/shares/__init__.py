"""Which errors matter: total effects on a length, and shares by region of the workspace.

A population and poses go in; out come the share of every error in the variance of the deviation,
exact to first order, and its total effect on the length |d|, by simulation.
"""

from matstd.sensitivity.shares.total_effect_indices import TotalEffects as TotalEffects
from matstd.sensitivity.shares.total_effect_indices import norm_shares as norm_shares
from matstd.sensitivity.shares.total_effect_indices import total_effects as total_effects
from matstd.sensitivity.shares.workspace_regions import Part as Part
from matstd.sensitivity.shares.workspace_regions import Place as Place
from matstd.sensitivity.shares.workspace_regions import Region as Region
from matstd.sensitivity.shares.workspace_regions import RegionTotals as RegionTotals
from matstd.sensitivity.shares.workspace_regions import region_totals as region_totals
from matstd.sensitivity.shares.workspace_regions import regions as regions
