"""300 touches of 20 000 candidates: choice, bound and certified efficiency, for I and for D.

`OMP_NUM_THREADS=1 python benchmarks/placement_certificate.py`. The candidates are random reachable
touches in the probed volume of the example machine; the errors are the project's own (set-up free).
"""

import platform
import time
from dataclasses import replace
from pathlib import Path

import numpy as np

from artefact.criterion import criterion, random_touches
from artefact.sites import Frame
from artefact.touchable import Probing
from probe_paths.probe import Probe
from sensitivity.certificate import bound_at, relaxed, rounded
from sensitivity.design import Selection, exchange, fill
from sensitivity.sampling import Population
from sensitivity.workspace import Workspace
from twin.files.machine_file import read_machine
from twin.touches import Setup
from twin.units import UM

CANDIDATES, TOUCHES = 20_000, 300
MACHINE = Path(__file__).parents[1] / "examples" / "hsm600u-machine.toml"


def main() -> list[tuple[str, float, float]]:
    """Print one line a criterion; return its name, efficiency and seconds."""
    print(f"{platform.machine()}, Python {platform.python_version()}, numpy {np.__version__}")
    print(f"matrix product: {_matrix_rate():.1f} GFlop/s")
    chain, probe = read_machine(MACHINE), Probe()
    probing = Probing(chain, Setup("a"), probe.shape, probe.length)
    rng = np.random.default_rng(1)
    model, workspace = Population(chain).model, Workspace(chain, {}, probe.length)
    aim = criterion(probing, model, Frame(), workspace, 1.0 * UM, rng)
    wanted = random_touches(probing, aim.volume, aim.rotary, CANDIDATES, rng)
    W = aim.rows(wanted)
    print(f"{W.shape[0]} candidates, {W.shape[1]} directions that touches or tool point feel")
    found = []
    for name, is_determinant in (("I", False), ("D", True)):
        purpose = replace(aim.purpose, is_determinant=is_determinant)
        start = time.perf_counter()
        greedy = Selection(purpose, W)
        fill(greedy, TOUCHES)
        swaps = exchange(greedy, most=TOUCHES)
        middle = time.perf_counter()
        best = relaxed(purpose, W, TOUCHES, greedy.chosen)
        end = time.perf_counter()
        whole = rounded(purpose, W, best.weight, TOUCHES)
        last = time.perf_counter()
        rows = W[greedy.chosen]
        first_bound = bound_at(purpose, W, rows.T @ rows, TOUCHES)[0]
        print(
            f"{name}: greedy and {swaps} exchanges {middle - start:.1f} s, "
            f"efficiency >= {best.bound / greedy.value:.4f} "
            f"(by the tangent at the choice itself {first_bound / greedy.value:.4f}); "
            f"relaxed {end - middle:.1f} s, {best.steps} steps, gap {best.gap:.4f}; "
            f"rounded and exchanged {last - end:.1f} s: {best.bound / whole.value:.4f}"
        )
        found.append((name, best.bound / min(greedy.value, whole.value), last - start))
    return found


def _matrix_rate() -> float:
    a = np.random.default_rng(0).normal(size=(1500, 1500))
    a @ a
    start = time.perf_counter()
    a @ a
    return float(2e-9 * 1500**3 / (time.perf_counter() - start))


if __name__ == "__main__":
    main()
