"""300 touches of 20 000 candidates for 126 coefficients: bound, choice and certified efficiency.

`OMP_NUM_THREADS=1 python benchmarks/placement_certificate.py`. The candidates are random reachable
touches in the probed volume of the example machine. Every component error of X, Y, Z has four
coefficients, every one of B and C two harmonics, and the set-up is free; then the same for the
errors of the example project. Efficiency is the bound over the choice's own criterion.
"""

import platform
import time
from pathlib import Path
from typing import NamedTuple

import numpy as np
from harness import matrix_rate

from matstd.artefact.layout import Blank
from matstd.artefact.reach import ProbeReach
from matstd.artefact.worth import CriterionOptions, criterion_for, random_touches
from matstd.information.selection import heaviest, relaxed, rounded
from matstd.probe_paths.plan import Probe
from matstd.sensitivity.first_order import Workspace
from matstd.sensitivity.population import Population
from matstd.twin.effects import HigherOrder, LocationError
from matstd.twin.files import read_machine
from matstd.twin.machine import Chain, Family, Ranges
from matstd.twin.model import Effect, Model
from matstd.twin.record import Setup
from matstd.twin.units import UM

CANDIDATES, TOUCHES = 20_000, 300
DEGREE, HARMONICS = 4, 2
MACHINE = Path(__file__).parents[1] / "examples" / "hsm600u-machine.toml"


class Result(NamedTuple):
    """One design: what for, of how many coefficients, how near the bound, how fast."""

    criterion: str
    coefficients: int
    efficiency: float
    seconds: float


def full_model(chain: Chain) -> Model:
    """Four coefficients a component of a linear axis, two harmonics a rotary one, the set-up."""
    ranges, effects = Ranges(), list[Effect]()
    for symbol in chain.symbols:
        sd = ranges.sd(chain, symbol)
        if symbol.family is Family.COMPONENT and chain.link(symbol.link).programmed:
            is_rotary = symbol.link in chain.rotary_axes
            degree = HARMONICS if is_rotary else DEGREE
            effects.append(HigherOrder(symbol, degree, sd, is_rotary))
        elif symbol.name.endswith("0w"):
            effects.append(LocationError(symbol, sd))
    return Model(chain, tuple(effects))


def main() -> list[Result]:
    """Print a line for each model and criterion."""
    print(f"{platform.machine()}, Python {platform.python_version()}, numpy {np.__version__}")
    print(f"matrix product: {matrix_rate():.1f} GFlop/s")
    chain = read_machine(MACHINE)
    found = []
    for model in (full_model(chain), Population(chain).model):
        found += _designs(chain, model)
    return found


def _designs(chain: Chain, model: Model) -> list[Result]:
    probe, rng = Probe(), np.random.default_rng(1)
    reach = ProbeReach(chain, Setup("a"), probe.shape, probe.length)
    workspace = Workspace(chain, {}, probe.length)
    criterion = criterion_for(
        reach,
        model,
        Blank(),
        workspace,
        1.0 * UM,
        rng,
        CriterionOptions(),
        TOUCHES,
        Population(chain),
    )
    wanted = random_touches(reach, criterion.volume, criterion.rotary, CANDIDATES, rng)
    W = criterion.rows(wanted)
    print(
        f"{len(model.names)} coefficients; {W.shape[0]} candidates, {W.shape[1]} directions that "
        "touches or tool point feel"
    )
    found = []
    for name in ("I", "D"):
        objective = criterion.objectives[name]
        start, cpu = time.perf_counter(), time.process_time()
        best = relaxed(objective, W, TOUCHES, heaviest(rng.random(len(W)), TOUCHES), 2e-3)
        middle = time.perf_counter()
        whole = rounded(objective, W, best.weight, TOUCHES)
        end = time.perf_counter()
        efficiency = best.bound / whole.value
        print(
            f"  {name}: bound {middle - start:.1f} s ({best.steps} steps, gap {best.gap:.4f}), "
            f"design {end - middle:.1f} s, {time.process_time() - cpu:.1f} s CPU in all; "
            f"certified efficiency {efficiency:.4f}"
        )
        found.append(Result(name, len(model.names), efficiency, end - start))
    return found


if __name__ == "__main__":
    main()
