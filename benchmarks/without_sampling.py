"""How fast are the maps without sampling?   python benchmarks/without_sampling.py [POSES]

Prints the time of mean and quantiles of the volumetric error from the covariance at every pose,
everything included but the table that is made at the first use, and the matrix-product rate.
"""

import sys
import time

import numpy as np
from harness import best_of, matrix_rate
from jacobians import LENGTH, MACHINE

from matstd.sensitivity.first_order import Workspace, covariance, latin_hypercube, normal_length
from matstd.sensitivity.population import Population
from matstd.twin.files import read_machine


def main(poses: int) -> None:
    """Print the figures."""
    chain = read_machine(MACHINE)
    population = Population(chain)
    q = latin_hypercube(Workspace(chain, {}, LENGTH), poses, np.random.default_rng(1))
    print(f"matrix product, float64: {matrix_rate():.0f} GFLOP/s")
    start = time.perf_counter()
    normal_length(np.eye(3)[None])
    print(f"table, once: {time.perf_counter() - start:.2f} s")
    C = covariance(population, q, LENGTH)
    first = best_of(lambda: covariance(population, q, LENGTH), repeats=15)
    second = best_of(lambda: normal_length(C), repeats=15)
    print(f"{poses} poses: covariance {1e3 * first:.1f} ms, lengths {1e3 * second:.1f} ms")


if __name__ == "__main__":
    main(*[int(word) for word in sys.argv[1:2]] or [10_000])
