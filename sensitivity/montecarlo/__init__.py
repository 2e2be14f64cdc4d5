"""Volumetric error of many random machines at many poses.

A population and poses go in; mean, quantiles, recurrence and exceedance with their standard errors
by sampling come out (`volumetric`). Batches of machines are the unit of work, which this process,
an executor or a Dask cluster does, to the same last bit.
"""

from matstd.sensitivity.montecarlo.batches import MACHINES_A_BATCH, seed_words
from matstd.sensitivity.montecarlo.dask_cluster import cluster
from matstd.sensitivity.montecarlo.lengths import BINS, count_lengths
from matstd.sensitivity.montecarlo.random_machines import (
    WORST_SHARE,
    ExactCheck,
    exact_check,
    volumetric,
)
from matstd.sensitivity.montecarlo.stability import Stability
from matstd.sensitivity.montecarlo.tally import Volumetric
from matstd.sensitivity.montecarlo.workers import Workers

__all__ = [
    "BINS", "MACHINES_A_BATCH", "WORST_SHARE", "ExactCheck", "Stability", "Volumetric", "Workers",
    "cluster", "count_lengths", "exact_check", "seed_words", "volumetric",
]  # fmt: skip
