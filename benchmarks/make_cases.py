"""Write unseen cases with known truth, in folders laid out like the reference cases.

    python benchmarks/make_cases.py -n 60 --seed 1 [--hard] -o DIR

Case k of a seed is the same whatever -n is. About a quarter hides nothing, an eighth hides an
effect from outside any library, the rest one effect, or up to two (three in harder ones).
"""

import json
import time
from functools import partial
from pathlib import Path

import numpy as np
from harness import in_processes, parser_of  # puts the simulator on the path
from simulator_case import simulate_case
from simulator_draw import draw, draw_unknown
from simulator_experiment import MACHINES

MACHINE_WEIGHTS = (0.6, 0.2, 0.2)
NOTHING, UNKNOWN = 0.25, 0.125
SEVERAL = {False: (0.85, 0.15), True: (0.55, 0.3, 0.15)}  # how many effects the rest hide
VISIBILITY = {False: (12.0, 40.0), True: (10.5, 28.0)}


def hidden_effects(rng: np.random.Generator, hard: bool) -> list:
    """What a case hides: nothing, one from outside any library, or one to three from it."""
    lot = rng.uniform()
    if lot < NOTHING:
        return []
    if lot < NOTHING + UNKNOWN:
        return [lambda rng, machine: draw_unknown(rng)]
    count = 1 + int(rng.choice(len(SEVERAL[hard]), p=SEVERAL[hard]))
    return [lambda rng, machine: draw(rng, machine, hard)] * count


def write_case(index: int, seed: int, hard: bool, folder: Path, alone: bool) -> str:
    """One case; returns its name."""
    rng = np.random.default_rng([seed, index, int(hard)])
    machine = str(rng.choice(list(MACHINES), p=MACHINE_WEIGHTS))
    hidden = [] if alone else hidden_effects(rng, hard)
    run, machine_file, truth = simulate_case(
        rng, machine, hidden, hard, signal_to_noise=VISIBILITY[hard]
    )
    name = f"{'hard' if hard else 'case'}{index:03d}"
    into = folder / name
    into.mkdir(parents=True, exist_ok=True)
    (into / "run.csv").write_text(run)
    (into / "machine.toml").write_text(machine_file)
    (into / "truth.json").write_text(json.dumps(truth, indent=1))
    return name


def main() -> None:
    parser = parser_of(__doc__)
    parser.add_argument("-n", type=int, default=60, help="number of cases")
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument(
        "--hard", action="store_true", help="chips, wrong noise, weaker, more kinds"
    )
    parser.add_argument("--nothing", action="store_true", help="hide nothing in any of them")
    parser.add_argument("--first", type=int, default=0, help="number of the first case")
    parser.add_argument("-j", "--jobs", type=int, default=1)
    parser.add_argument("-o", "--output", type=Path, required=True)
    a = parser.parse_args()
    start = time.perf_counter()
    one = partial(write_case, seed=a.seed, hard=a.hard, folder=a.output, alone=a.nothing)
    numbers = range(a.first, a.first + a.n)
    names = in_processes(one, numbers, a.jobs)
    print(f"{len(names)} cases in {a.output}, {time.perf_counter() - start:.0f} s")


if __name__ == "__main__":
    main()
