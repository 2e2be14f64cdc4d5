"""Volumetric error of many random machines at many poses."""

from sensitivity.montecarlo.batches import MACHINES_A_BATCH, seed_words
from sensitivity.montecarlo.dask_cluster import cluster
from sensitivity.montecarlo.exact import ExactCheck, exact_check
from sensitivity.montecarlo.lengths import BINS, count_lengths
from sensitivity.montecarlo.random_machines import Volumetric, volumetric
from sensitivity.montecarlo.workers import Crew

__all__ = [
    "BINS",
    "MACHINES_A_BATCH",
    "Crew",
    "ExactCheck",
    "Volumetric",
    "cluster",
    "count_lengths",
    "exact_check",
    "seed_words",
    "volumetric",
]
