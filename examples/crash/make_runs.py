"""Writes the runs of this example: a machine in spring, in summer, and after a collision.

The simulator (tests/oracles) multiplies 4x4 matrices, moves the axes until the ball meets the
curved surface, and shares no code with what analyses the runs.
"""

import sys
from pathlib import Path

import numpy as np

HERE = Path(__file__).resolve().parent
sys.path[:0] = [str(HERE.parents[1]), str(HERE.parents[1] / "tests" / "oracles")]

from simulator_effects import warm_up  # noqa: E402  (found through the path above)
from simulator_experiment import MACHINES  # noqa: E402
from simulator_runs import simulated_runs  # noqa: E402

CRASH = {"EC0Y": 38.0e-6, "EX0C": 12.0e-3}
"""What the collision did: Y knocked out of square to X, rad, and the line of C moved, mm."""

RUNS = {"spring": {}, "summer": {}, "after_crash": CRASH}

MACHINE, SEED, POSES = "hsm600u", 5, 6

GROWTH = 7.0  # growth of the spindle along Z with 25 minutes, in every run, µm


def write(folder: Path = HERE) -> None:
    spindle = warm_up("EZZ", 25.0)
    spindle.amplitude = GROWTH
    rng = np.random.default_rng(SEED)
    texts = simulated_runs(rng, MACHINE, list(RUNS.values()), [spindle], POSES, same_standard=True)
    (folder / "machine.toml").write_text(MACHINES[MACHINE], encoding="utf-8")
    for name, text in zip(RUNS, texts, strict=True):
        (folder / f"{name}.csv").write_text(text, encoding="utf-8")


if __name__ == "__main__":
    write()
