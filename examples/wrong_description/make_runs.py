"""Writes the runs of this example: machines that are not what their files say.

The simulator (tests/oracles) multiplies 4x4 matrices, moves the axes until the ball meets the
curved surface, and shares no code with what analyses the runs. What is wrong is written into the
files afterwards, as a user would have written it.
"""

import sys
from pathlib import Path

import numpy as np

HERE = Path(__file__).resolve().parent
sys.path[:0] = [str(HERE.parents[1]), str(HERE.parents[1] / "tests" / "oracles")]

from simulator_experiment import MACHINES  # noqa: E402  (found through the path above)
from simulator_runs import simulated_runs  # noqa: E402

RIGHT = MACHINES["hsm600u"]
TABLE = "[axis.C]\nrange = [-360.0, 360.0]\n"

WRONG = {
    "pivot": ("point = [0.0, 0.0, -420.0]", "point = [0.0, 0.0, -418.0]"),
    "direction": (TABLE, TABLE + "direction = [0.0, 0.0, -1.0]\n"),
    "ball": ("radius_mm = 3.0", "radius_mm = 2.9"),
}
"""Run: what is right, in the machine file or in the head of the run, and what the user wrote."""

POSES = 4


def write(folder: Path = HERE) -> None:
    for seed, (name, (right, wrong)) in enumerate(WRONG.items(), start=21):
        (run,) = simulated_runs(np.random.default_rng(seed), "hsm600u", [{}], poses=POSES)
        run = run.replace('machine = "machine.toml"', f'machine = "{name}_machine.toml"')
        (folder / f"{name}.csv").write_text(run.replace(right, wrong), encoding="utf-8")
        machine = RIGHT.replace(right, wrong)
        (folder / f"{name}_machine.toml").write_text(machine, encoding="utf-8")


if __name__ == "__main__":
    write()
