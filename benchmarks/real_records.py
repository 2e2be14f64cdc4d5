"""Real records: how well the diagnosis predicts what it was not fitted to, plainly, in µm.

    python benchmarks/real_records.py [--frames ../shared/data/voron_frame] [--only spindle]

`examples/fl_thermal` is fitted on its first 32 hours and judged by all rows of the rest. The record
of a printer's frame (nozzle on a pin; another licence, so it is no part of the project) is read
where it stands: medians of three touches, every second half hour held out; one file fitted whole
then predicts another.
"""

import argparse
import csv
import sys
import time
from datetime import datetime
from pathlib import Path

import numpy as np

ROOT = Path(__file__).resolve().parents[1]
sys.path[:0] = [str(ROOT), str(ROOT / "examples" / "fl_thermal")]
FRAMES = ROOT.parent / "shared" / "data" / "voron_frame"

STEP_UM = 2.5
SENSORS = ("frame_t", "chamber_t", "bed_t", "he_t")
NO_SENSOR = -100.0
HALF_HOUR = 1800.0
STATED_UM = 1.2  # scatter of three touches a few seconds apart


def frame_table(path: Path) -> dict[str, np.ndarray]:
    """Time (s), deviation (µm) and temperatures, medians of the touches of a sample."""
    lines = [line for line in path.read_text().splitlines() if not line.startswith("#")]
    rows = list(csv.DictReader(lines))
    clock = [datetime.strptime(r["time"], "%Y/%m/%d-%H:%M:%S").timestamp() for r in rows]
    sample = np.array([int(r["sample"]) for r in rows])
    raw = {"time": np.array(clock) - clock[0]}
    raw["dev_um"] = np.array([float(r["mcu_pos_z"]) for r in rows]) * STEP_UM
    for sensor in SENSORS:
        values = np.array([float(r[sensor]) for r in rows])
        if values.min() > NO_SENSOR:
            raw[sensor.removesuffix("_t")] = values
    out = {
        k: np.array([np.median(v[sample == s]) for s in np.unique(sample)]) for k, v in raw.items()
    }
    return out | {"dev_um": out["dev_um"] - out["dev_um"][0]}


def frame_run(path: Path, whole: bool = False):
    """The record as a run of a machine with one axis, read along +z."""
    from matstd.twin.machine import Axis, make_chain
    from matstd.twin.record import Run, Setup, Touches
    from matstd.twin.units import UM

    table = frame_table(path)
    n = len(table["time"])
    touches = Touches(
        chain=make_chain("printer", "[w f Z t]", {"Z": Axis((0.0, 350.0))}),
        q=np.zeros((n, 1)),
        length=np.zeros(n),
        radius=np.zeros(n),
        point=np.zeros((n, 3)),
        normal=np.tile([0.0, 0.0, 1.0], (n, 1)),
        setups=(Setup("a"),),
        setup=np.zeros(n, dtype=np.int64),
        time=table["time"],
        approach=np.zeros((n, 1)),
        temperature={k: v for k, v in table.items() if k not in ("time", "dev_um")},
    )
    odd = (table["time"] // HALF_HOUR).astype(int) % 2 == 1
    split = np.full(n, "") if whole else np.where(odd, "test", "train")
    return Run(touches, table["dev_um"] * UM, np.full(n, STATED_UM * UM), split)


def plain(fit) -> float:
    """Root mean square error of every held-out row, µm."""
    from matstd.twin.units import UM

    rows = fit.run.split == "test"
    return float(np.sqrt(np.mean(fit.residual[rows] ** 2))) / UM


def report(name: str, run):
    """Diagnose a record and say what came out."""
    from matstd.diagnosis.answer import diagnose
    from matstd.report.words import sizes

    start = time.perf_counter()
    result = diagnose(run)
    seconds = time.perf_counter() - start
    way = f"by prediction: {result.choice.best.name}" if result.choice else "by search"
    held = f"held out {plain(result.fit):.2f} µm, " if np.any(run.split == "test") else ""
    print(f"{name}: {held}{result.verdict.value}, {way}, {seconds:.0f} s")
    for step in result.steps[1:]:
        print(f"    {step.effect.name}: {sizes(step, 2)}")
    return result


def transfer(source, path: Path) -> tuple[float, float]:
    """Error of a record predicted by a model of another, and what that model promised, µm."""
    from matstd.diagnosis.answer import compare
    from matstd.diagnosis.fit import Prior
    from matstd.twin.units import UM

    fit = source.fit
    count = len(fit.model.parameters)
    estimates = Prior.of_estimates(fit.theta[:count], fit.covariance[:count, :count])
    found = compare(frame_run(path, whole=True), fit.model, estimates)
    return found.rms / UM, source.promise.elsewhere / UM


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--frames", type=Path, default=FRAMES)
    parser.add_argument("--only", choices=("spindle", "frames"))
    args = parser.parse_args()
    if args.only != "frames":
        from make_run import spindle_run

        report("spindle", spindle_run())
    if args.only == "spindle" or not args.frames.is_dir():
        return
    for name in "ABCD":
        report(name, frame_run(args.frames / f"{name}.csv"))
    whole = report("C whole", frame_run(args.frames / "C.csv", whole=True))
    error, promised = transfer(whole, args.frames / "D.csv")
    print(f"C predicts D: {error:.2f} µm, promised were {promised:.2f} µm")


if __name__ == "__main__":
    main()
