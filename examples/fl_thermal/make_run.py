"""Turns five displacement probes around a spindle into a run file.

    python examples/fl_thermal/make_run.py [RUN.csv]

A row is one probe at one instant: the direction in which it looks, and what it reads. Where the
probes stand is not documented upstream. Two of them move together, two others too, and one goes its
own way, as in the nest of ISO 230-3: so the first pair is put along X, the second along Y, the last
along Z. Another choice renames the effects and changes no error in µm. The two of a pair would part
by tilt times their distance, which is not known: that part stays in the residual.
"""

import csv
import gzip
import os
import sys
from pathlib import Path

import numpy as np

from matstd.twin.files import read_machine, write_run
from matstd.twin.record import Run, Setup, Touches
from matstd.twin.units import UM

HERE = Path(__file__).resolve().parent
PROBES = {
    "ch1": ((0.0, 0.0, 0.0), (1.0, 0.0, 0.0)),
    "ch2": ((0.0, 0.0, 100.0), (1.0, 0.0, 0.0)),
    "ch3": ((0.0, 0.0, 0.0), (0.0, 1.0, 0.0)),
    "ch4": ((0.0, 0.0, 100.0), (0.0, 1.0, 0.0)),
    "ch5": ((0.0, 0.0, 0.0), (0.0, 0.0, 1.0)),
}
"""Point (mm) and direction of every probe: assumed, see above. With two points in a pair the free
set-up gives every probe a zero of its own."""

NOISE = 0.1 * UM  # sample-to-sample scatter of the probes, one standard deviation

FIRST, EVERY = 3, 5
"""Of the one-minute record a row every five minutes; so begun, every change of speed falls within
a minute after a row."""

CYCLE, REST = 8 * 3600.0, 432.0
"""Every speed runs four hours and rests four; before the first there is a rest (s)."""

TRAIN_UNTIL = 32.13 * 3600.0
"""End of the fourth cycle: what comes later, a new speed and a staircase, is never fitted (s)."""


def record(every: int = EVERY) -> dict[str, np.ndarray]:
    """The record by column, thinned."""
    with gzip.open(HERE / "fl_thermal_1min.csv.gz", "rt", encoding="utf-8") as file:
        head, *rows = csv.reader(file)
    table = np.array(rows[FIRST::every], dtype=float)
    return {name: table[:, i] for i, name in enumerate(head)}


def spindle_run(every: int = EVERY) -> Run:
    """All probes at all instants; a pose is a cycle of the schedule: speeds are held out whole."""
    data = record(every)
    n, k = len(data["time_s"]), len(PROBES)
    time = np.repeat(data["time_s"], k)
    touches = Touches(
        chain=read_machine(HERE / "spindle.toml"),
        q=np.zeros((n * k, 1)),
        length=np.zeros(n * k),
        radius=np.zeros(n * k),
        point=np.tile([p for p, _ in PROBES.values()], (n, 1)),
        normal=np.tile([d for _, d in PROBES.values()], (n, 1)),
        setups=(Setup("nest"),),
        setup=np.zeros(n * k, dtype=np.int64),
        time=time,
        approach=np.zeros((n * k, 1)),
        temperature={f"t{i}": np.repeat(data[f"t{i}_degC"], k) for i in range(1, 17)},
        spindle_rpm=np.repeat(data["spindle_rpm"], k),
        feature=np.tile(list(PROBES), n),
        pose=np.clip((time - REST) // CYCLE, 0, None).astype(np.int64),
    )
    deviation = np.stack([data[f"{name}_um"] for name in PROBES], axis=1).reshape(-1) * UM
    split = np.where(time < TRAIN_UNTIL, "train", "test")
    return Run(touches, deviation, np.full(n * k, NOISE), split)


if __name__ == "__main__":
    path = Path(sys.argv[1]) if len(sys.argv) > 1 else HERE / "run.csv"
    run = spindle_run()
    machine = Path(os.path.relpath(HERE / "spindle.toml", path.resolve().parent))
    write_run(path, run, machine.as_posix())
    print(f"{path}: {len(run)} rows, {int((run.split == 'test').sum())} of them held out")
