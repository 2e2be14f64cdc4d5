"""How fast and how good is the Monte Carlo?   python benchmarks/montecarlo.py [DRAWS] [POSES]

Prints the time of mean, standard deviation, quantiles and recurrence of the volumetric error, the
rate of the product it rests on against the plain matrix-product rate of the same run, the error of
the histogram's quantile against sorting, and the sampling error that is stated beside it.
"""

import platform
import resource
import sys
import time
from functools import partial
from pathlib import Path

import numpy as np
from harness import best_of, matrix_rate

from matstd.sensitivity.first_order import Workspace, latin_hypercube, rms
from matstd.sensitivity.montecarlo import BINS, count_lengths, volumetric
from matstd.sensitivity.population import Distributions, Population, coefficients, drawn_in_chunks
from matstd.twin.compute import one_blas_thread
from matstd.twin.files import read_machine
from matstd.twin.record import at_poses
from matstd.twin.units import UM

MACHINE = Path(__file__).parent.parent / "examples" / "hsm600u-machine.toml"
LENGTH = 160.0


def one_thread(columns):
    """Rate of one thread over that of a plain product on one thread, by processor time."""
    rng = np.random.default_rng(0)
    G, theta = rng.normal(size=(2048, 3, columns)), rng.normal(size=(columns, 10_240))
    width, a = np.full(2048, 5.0 * np.sqrt(3 * columns) / BINS), rng.normal(size=(1500, 1500))
    count_lengths(G[:2], theta, width[:2], threads=1)

    def processor_time(work):
        return best_of(work, 4, time.process_time)

    with one_blas_thread():
        plain = 2.0 * 1500**3 / processor_time(lambda: a @ a)
    counted = processor_time(lambda: count_lengths(G, theta, width, threads=1))
    return 2.0 * 3 * G.shape[0] * theta.size / counted / plain


def engine(population, q, draws):
    """Seconds that the product with its counting takes, compiled and in numpy."""
    G = population.model.tip_columns(at_poses(population.chain, q, LENGTH))
    lots = drawn_in_chunks(population, draws, np.random.default_rng(2))
    theta = np.concatenate([coefficients(population, lot) for lot in lots]).T.copy()
    width = rms(population, q, LENGTH) * (5.0 / BINS)
    count_lengths(G[:20], theta, width[:20], worst=(20, 1))  # compiles
    taken = {}
    all_poses = (len(q), round(0.05 * len(q)))
    for what, compiled, worst in (
        ("compiled", True, (0, 0)),
        ("compiled, with the worst poses of every machine", True, all_poses),
        ("numpy", False, (0, 0)),
    ):
        work = partial(count_lengths, G, theta, width, use_compiled=compiled, worst=worst)
        taken[f"product and counting, {what}"] = best_of(work, 3)
    return taken


def main(draws: int, poses: int) -> None:
    """Print the figures."""
    chain = read_machine(MACHINE)
    q = latin_hypercube(Workspace(chain, {}, LENGTH), poses, np.random.default_rng(1))
    print(f"{platform.processor() or platform.machine()}, numpy {np.__version__}")
    print(f"matrix product, float64: {matrix_rate():.0f} GFLOP/s, all BLAS threads of this run")
    for shapes in (("constant",), ("linear", "parabolic", "sinusoidal")):
        turning = shapes if len(shapes) == 1 else ("sinusoidal",)
        population = Population(chain, distributions=Distributions(shapes, turning))
        columns = len(population.model.parameters)
        print(f"{draws} machines x {poses} poses, {columns} columns")
        rows = engine(population, q, draws)
        start = time.perf_counter()
        found = volumetric(population, q, LENGTH, draws, np.random.default_rng(2), recurrence=False)
        rows["everything, columns and draws included"] = time.perf_counter() - start
        now = max(matrix_rate() for _ in range(3))
        for what, taken in rows.items():
            speed = 2.0 * 3 * poses * draws * columns / taken / 1e9
            print(f"  {what}: {taken:.2f} s, {speed:.0f} GFLOP/s = {speed / now:.0%} of {now:.0f}")
        print(f"  one thread, by processor time: {one_thread(columns):.0%} of the product's rate")
        print(f"  stated sampling error of the P95: {np.mean(found.p95_u) / UM:.2f} µm")
    some = slice(0, 50)
    theta = np.concatenate(
        [
            coefficients(population, lot)
            for lot in drawn_in_chunks(population, draws, np.random.default_rng(2))
        ]
    )
    G = population.model.tip_columns(at_poses(chain, q[some], LENGTH))
    sorted_p95 = np.quantile(
        np.linalg.norm(np.einsum("nik,sk->nsi", G, theta), axis=2), 0.95, axis=1
    )
    off = np.abs(found.p95[some] / sorted_p95 - 1.0)
    print(
        f"P95 by histogram against sorting, 50 poses: {off.mean():.1e} mean, {off.max():.1e} worst"
    )
    print(f"memory: {resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1024:.0f} MiB")


if __name__ == "__main__":
    numbers = [int(word) for word in sys.argv[1:3]]
    main(*(numbers + [2000, 2000][len(numbers) :]))
