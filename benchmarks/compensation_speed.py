"""How fast a program is compensated: 100 000 points with 71 errors; and one point.

    python benchmarks/compensation_speed.py

Prints seconds of processor for reading, compensating and writing a program of 100 000 short lines
on the example machine with every error of the ordinary model, and the time of one compensation.
"""

import tempfile
import time
from pathlib import Path

import numpy as np

from matstd.compensation.field import MachineErrors, State, correction, datum_of, sample_workspace
from matstd.compensation.part_programs import Frame, read_part_program
from matstd.compensation.programs import compensated
from matstd.compensation.service import PointCorrection
from matstd.compensation.tables import header_of
from matstd.twin.files import read_machine
from matstd.twin.library import ordinary_model
from matstd.twin.units import NM

MACHINE = Path(__file__).parents[1] / "examples" / "hsm600u-machine.toml"
POINTS, SINGLE, REPEATED = 100_000, 2_000, 10


def drawn_errors(rng: np.random.Generator) -> MachineErrors:
    """Every error of the ordinary model at a tenth of its expected size."""
    chain = read_machine(MACHINE)
    known = [
        (e, 0.1 * rng.normal(size=len(e.parameters)) * np.array([p.sd for p in e.parameters]))
        for e in ordinary_model(chain).effects
    ]
    return MachineErrors.of_errors(chain, known)


def main() -> None:
    """Print both figures."""
    rng = np.random.default_rng(1)
    errors = drawn_errors(rng)
    datum = datum_of(errors.chain, {"Z": -200.0}, 160.0)
    turn = np.linspace(0.0, 400.0 * np.pi, POINTS)
    radius = np.linspace(5.0, 100.0, POINTS)
    spiral = zip(radius * np.cos(turn), radius * np.sin(turn), -0.1 * radius, strict=True)
    lines = ["G0 X5 Y0 Z5", *(f"G1 X{x:.4f} Y{y:.4f} Z{z:.4f} F3000" for x, y, z in spiral)]
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "spiral.ngc"
        path.write_text("\n".join(lines) + "\n")
        begun = time.process_time()
        program = read_part_program(path, Frame(errors.chain, datum))
        read = time.process_time()
        head = header_of(errors.chain, "benchmark", datum, State())
        done = compensated(program, errors, head)
        ended = time.process_time()
    worst = np.linalg.norm(done.after, axis=1).max() * 1e3
    print(f"{len(errors.effects)} effects, {len(done.q)} points, worst left {worst:.4f} µm")
    print(f"read {read - begun:.2f} s, compensated and written {ended - read:.2f} s")
    begun = time.process_time()
    point = PointCorrection(errors, 160.0, datum)
    made = time.process_time() - begun
    q = sample_workspace(errors.chain, {}, SINGLE)
    exact = correction(errors, errors.touches(q, 160.0), datum.deviation(errors))
    columns = [errors.chain.axis_index(name) for name in point.linear_axes]
    times, found = [], []
    for row in q.tolist() * REPEATED:
        begun = time.perf_counter()
        found.append(point.at(row))
        times.append(time.perf_counter() - begun)
    off = np.abs(np.array(found[:SINGLE]) - exact[:, columns]).max() / NM
    median, most = np.quantile(times, [0.5, 0.999]) * 1e6
    print(f"tables made in {made:.2f} s, {off:.1f} nm from the exact inverse at most")
    print(f"one compensation: median {median:.0f} µs, 99.9 % below {most:.0f} µs")


if __name__ == "__main__":
    main()
