"""Volumetric error of many random machines at many poses.

A population and poses go in; mean, quantiles, recurrence and exceedance with their standard errors
by sampling come out (`volumetric`). Batches of machines are the unit of work, which this process,
an executor or a Dask cluster does, to the same last bit.
"""

from sensitivity.montecarlo.batches import MACHINES_A_BATCH, seed_words
from sensitivity.montecarlo.dask_cluster import cluster
from sensitivity.montecarlo.exact import ExactCheck, exact_check
from sensitivity.montecarlo.lengths import BINS, count_lengths
from sensitivity.montecarlo.random_machines import volumetric
from sensitivity.montecarlo.stability import Stability
from sensitivity.montecarlo.tally import Volumetric
from sensitivity.montecarlo.workers import Workers

__all__ = [
    "BINS",
    "MACHINES_A_BATCH",
    "ExactCheck",
    "Stability",
    "Volumetric",
    "Workers",
    "cluster",
    "count_lengths",
    "exact_check",
    "seed_words",
    "volumetric",
]
