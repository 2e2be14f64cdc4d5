"""Writes the runs of this example: an exact simulator, with physics that the model lacks.

The simulator (tests/oracles) multiplies 4x4 matrices, moves the axes until the ball meets the
curved surface, and shares no code with what analyses the runs.
"""

import json
import sys
from pathlib import Path

import numpy as np

HERE = Path(__file__).resolve().parent
sys.path[:0] = [str(HERE.parents[1]), str(HERE.parents[1] / "tests" / "oracles")]

from simulator_case import simulate_case  # noqa: E402  (found through the path above)
from simulator_effects import cable  # noqa: E402

HIDDEN = {
    "warm_up": (7, ["thermal-lag(EZZ)"], True),
    "hose": (11, [cable(x=35.0, width=40.0, y=-20.0)], False),
}
"""Run: seed, what it hides, and whether chips lie about and the noise is not what the file says."""


def write(name: str, folder: Path = HERE) -> None:
    seed, hidden, hard = HIDDEN[name]
    rng = np.random.default_rng(seed)
    run, machine, truth = simulate_case(
        rng, "hsm600u", hidden, hard, signal_to_noise=(35.0, 40.0), with_alike=False
    )
    (folder / f"{name}.csv").write_text(run, encoding="utf-8")
    (folder / "machine.toml").write_text(machine, encoding="utf-8")
    (folder / f"{name}_truth.json").write_text(json.dumps(truth, indent=1) + "\n", encoding="utf-8")


if __name__ == "__main__":
    for name in HIDDEN:
        write(name)
