"""Time and memory of the diagnosis of a usual and of a long run with a known hidden effect.

    python benchmarks/diagnosis_scale.py [--touches 800 20000]

Each run comes from the independent exact simulator and is diagnosed, full library, in a process of
its own. As a measure of the machine at hand the time is also given in QR factorisations of the
ordinary model's columns at the same touches.
"""

import argparse
import resource
import subprocess
import sys
import tempfile
import time
from pathlib import Path

import numpy as np
from harness import parser_of

HIDDEN = "thermal-expansion(Y,scaleY)"
PER_POSE, SETUPS = 26, 3


def write(folder: Path, touches: int) -> None:
    """A run of about so many touches."""
    from simulator_case import simulate_case

    poses = max(round(touches / PER_POSE / SETUPS), 10)
    run, machine, _ = simulate_case(
        np.random.default_rng(5), "hsm600u", [HIDDEN], with_alike=False, poses=poses
    )
    (folder / "machine.toml").write_text(machine)
    (folder / "run.csv").write_text(run)


def measure(path: Path) -> None:
    """Diagnose a run and say what it took."""
    from matstd.diagnosis.answer import diagnose
    from matstd.twin.files import read_run
    from matstd.twin.library import ordinary_model

    run = read_run(path)
    X = ordinary_model(run.touches.chain).columns(run.touches)
    start = time.process_time()
    np.linalg.qr(X)
    reference = time.process_time() - start
    wall, start = time.perf_counter(), time.process_time()
    result = diagnose(run, rng=np.random.default_rng(0))
    cpu, wall = time.process_time() - start, time.perf_counter() - wall
    found = ", ".join(e.name for e in result.found) or "-"
    memory = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 2**20
    print(
        f"{len(run):6} touches: {wall:6.1f} s, {cpu:6.1f} s of processor = {cpu / reference:5.0f} "
        f"QRs of {X.shape[1]} columns; {memory:.2f} GiB; {result.verdict.value}: {found} "
        f"(hidden: {HIDDEN})",
        flush=True,
    )


def main() -> None:
    parser = parser_of(__doc__)
    parser.add_argument("--touches", type=int, nargs="+", default=[800, 20000])
    parser.add_argument("--run", type=Path, help=argparse.SUPPRESS)
    a = parser.parse_args()
    if a.run is not None:
        measure(a.run)
        return
    for touches in a.touches:
        with tempfile.TemporaryDirectory() as folder:
            write(Path(folder), touches)
            own = [sys.executable, __file__, "--run", f"{folder}/run.csv"]
            subprocess.run(own, check=True)


if __name__ == "__main__":
    main()
