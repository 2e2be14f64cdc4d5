"""Volumetric error of many random machines at many poses.

A population and poses go in; mean, quantiles, recurrence and exceedance with their standard errors
by sampling come out (`volumetric`). Batches of machines are the unit of work, which this process,
an executor or a Dask cluster does, to the same last bit.
"""

from matstd.sensitivity.montecarlo.dask_cluster import cluster as cluster
from matstd.sensitivity.montecarlo.lengths import BINS as BINS
from matstd.sensitivity.montecarlo.lengths import count_lengths as count_lengths
from matstd.sensitivity.montecarlo.random_machines import MACHINES_A_BATCH as MACHINES_A_BATCH
from matstd.sensitivity.montecarlo.random_machines import WORST_SHARE as WORST_SHARE
from matstd.sensitivity.montecarlo.random_machines import ExactCheck as ExactCheck
from matstd.sensitivity.montecarlo.random_machines import exact_check as exact_check
from matstd.sensitivity.montecarlo.random_machines import seed_words as seed_words
from matstd.sensitivity.montecarlo.random_machines import volumetric as volumetric
from matstd.sensitivity.montecarlo.stability import Stability as Stability
from matstd.sensitivity.montecarlo.tally import Volumetric as Volumetric
from matstd.sensitivity.montecarlo.workers import Workers as Workers
