"""How fast are the Jacobians of all error parameters?   python benchmarks/jacobians.py

Prints poses per second of `sensitivity.jacobian` (all 71 parameters of the HSM 600U), of central
differences of the exact product, and of pinocchio's kinematic regressor where it is installed, with
the matrix-product rate of the same run.
"""

import platform
import time
from collections.abc import Callable
from pathlib import Path

import numpy as np

from sensitivity.jacobian import jacobian
from sensitivity.workspace import Workspace, latin_hypercube
from twin.effect import Contribution
from twin.files.machine_file import read_machine
from twin.kinematics import exact_tip
from twin.symbols import Family

MACHINE = Path(__file__).parent.parent / "examples" / "hsm600u-machine.toml"
LENGTH = 160.0


def best_of(work: Callable[[], object], repeats: int = 5) -> float:
    """Shortest of some timings, s."""
    times = []
    for _ in range(repeats):
        start = time.perf_counter()
        work()
        times.append(time.perf_counter() - start)
    return min(times)


def matrix_rate() -> float:
    """float64 matrix products, GFLOP/s."""
    a = np.random.default_rng(0).normal(size=(1500, 1500))
    return 2 * 1500**3 / best_of(lambda: a @ a) / 1e9


def central_differences(chain, q):
    """Jacobian by two exact products a parameter."""
    out = np.empty((len(q), len(chain.symbols), 3))
    for p, symbol in enumerate(chain.symbols):
        h = 1e-4 if symbol.is_angular else 0.1
        moved = []
        for size in (h, -h):
            added = Contribution.zeros(len(q), len(chain.links))
            part = added.twist if symbol.family is Family.COMPONENT else added.place
            part[:, chain.link_index(symbol.link), symbol.component] = size
            moved.append(exact_tip(chain, q, LENGTH, added))
        out[:, p] = (moved[0] - moved[1]) / (2.0 * h)
    return out


def main() -> None:
    """Print the figures."""
    chain = read_machine(MACHINE)
    q = latin_hypercube(Workspace(chain, {}, LENGTH), 20_000, np.random.default_rng(1))
    print(f"{platform.processor() or platform.machine()}, numpy {np.__version__}")
    print(f"matrix product, float64: {matrix_rate():.0f} GFLOP/s")
    closed = best_of(lambda: jacobian(chain, q, LENGTH))
    print(f"closed form, {len(chain.symbols)} parameters: {len(q) / closed:,.0f} poses/s")
    few = q[:500]
    slow = best_of(lambda: central_differences(chain, few), repeats=2)
    print(f"central differences: {len(few) / slow:,.0f} poses/s")
    worst = np.abs(central_differences(chain, few) - jacobian(chain, few, LENGTH)).max()
    print(f"largest difference between the two: {worst:.1e} mm/rad")


if __name__ == "__main__":
    main()
