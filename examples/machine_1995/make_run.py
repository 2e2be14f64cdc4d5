"""Writes the run of this example: a horizontal machining centre as bad as one of 1995.

Sizes are those that J. S. Chen published of such a machine (1995): positioning errors of 90 µm in
750 mm of X and 157 µm in 500 mm of Z, pitch of the table of 58 and 223 µrad along X and Z, 15
arcseconds between Y and Z, 82 µm of drift in Z over hours. The rest is drawn at random.

The simulator (tests/oracles) multiplies 4x4 matrices, moves the axes until the ball meets the
curved surface, and shares no code with what analyses the run.
"""

import sys
from pathlib import Path

import numpy as np

HERE = Path(__file__).resolve().parent
sys.path[:0] = [str(HERE.parents[1]), str(HERE.parents[1] / "tests" / "oracles")]

from simulator import probe, run_text  # noqa: E402  (found through the path above)
from simulator_effects import scale_growth, warm_up  # noqa: E402
from simulator_experiment import MACHINES, constant, random_experiment  # noqa: E402

LABEL, SEED, POSES = "hmc1995", 1995, 6

NOISE = 2.0e-3  # of one touch, mm: a probe of that time

SLOPES = {"EXX": 90.0e-3 / 750.0, "EZZ": 157.0e-3 / 500.0, "ECX": 58.0e-6 / 750.0}
SLOPES |= {"EAZ": 223.0e-6 / 500.0}
"""Errors that grow along their axis, mm/mm and rad/mm."""

SQUARENESS = {"EA0Z": 73.0e-6}  # between Y and Z, rad
DRIFT, MINUTES = 82.0, 90.0  # of the datum of Z after switching on, µm, and its time constant
SCREW = 12.0  # growth of the screw of Y, a steel one, µm/(m K)

WARMTH = 4.0
"""Factor on the temperature of that screw in the simulator's usual experiment: 12 K in the end."""


def sloping(axis: str, slope: float):
    return lambda q: slope * q[axis]


def write(folder: Path = HERE) -> None:
    rng = np.random.default_rng(SEED)
    e = random_experiment(rng, LABEL, POSES)
    e.errors |= {name: sloping(name[2], slope) for name, slope in SLOPES.items()}
    e.errors |= {name: constant(size) for name, size in SQUARENESS.items()}
    e.temperature["scaleY"] = 20.0 + WARMTH * (e.temperature["scaleY"] - 20.0)
    drift, screw = warm_up("EZZ", MINUTES), scale_growth("Y", "scaleY")
    drift.amplitude, screw.amplitude = DRIFT, SCREW
    noise = rng.normal(0.0, NOISE, len(e.time))
    text = run_text(e, probe(e, [drift, screw], noise), with_speed=False)
    text = text.replace("# u_um = 0.6", f"# u_um = {NOISE * 1e3:.1f}")
    (folder / "run.csv").write_text(text, encoding="utf-8")
    (folder / "machine.toml").write_text(MACHINES[LABEL], encoding="utf-8")


if __name__ == "__main__":
    write()
