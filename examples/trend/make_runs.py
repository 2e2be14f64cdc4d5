"""Writes the runs of this example: one machine, probed once a week for ten weeks.

The simulator (tests/oracles) multiplies 4x4 matrices, moves the axes until the ball meets the
curved surface, and shares no code with what analyses the runs.
"""

import sys
from datetime import date, timedelta
from pathlib import Path

import numpy as np

HERE = Path(__file__).resolve().parent
sys.path[:0] = [str(HERE.parents[1]), str(HERE.parents[1] / "tests" / "oracles")]

from simulator_experiment import MACHINES  # noqa: E402  (found through the path above)
from simulator_runs import simulated_runs  # noqa: E402

WEEKS, FIRST = 10, date(2026, 1, 12)

JUMP, AFTER = 15.0e-3, 4  # the line of the table axis C moves in X, mm, after so many runs
DRIFT = -4.0e-6  # squareness of Y to X from week to week, rad

MACHINE, SEED, POSES = "hsm600u", 11, 3


def changes(week: int) -> dict[str, float]:
    """By how much errors differ from those of the first week."""
    return {"EC0Y": week * DRIFT} | ({"EX0C": JUMP} if week >= AFTER else {})


def write(folder: Path = HERE) -> None:
    rng = np.random.default_rng(SEED)
    every = [changes(week) for week in range(WEEKS)]
    texts = simulated_runs(rng, MACHINE, every, (), POSES, same_standard=True)
    (folder / "machine.toml").write_text(MACHINES[MACHINE], encoding="utf-8")
    for week, text in enumerate(texts):
        day = FIRST + timedelta(weeks=week)
        dated = text.replace("\n", f"\n# date = {day}\n", 1)
        (folder / f"{day}.csv").write_text(dated, encoding="utf-8")


if __name__ == "__main__":
    write()
