"""Whether a law is blamed on another sensor where the responsible one was not recorded.

    python benchmarks/deleted_driver.py [-n 24] [--seed 1] [DIR ...]

Each case is simulated exactly: one effect follows a temperature or the spindle speed, and a second
run of the same machine stands elsewhere, on another day. It is diagnosed with all columns, and with
that of its driver deleted. Then no effect may be named that follows another sensor, and the second
run may not be predicted worse than by the model without any effect. A DIR is a case as
`other_cases.py` reads it; those that hide an effect that follows a sensor are treated alike.
"""

import argparse
import csv
import io
import json
import sys
from collections.abc import Callable, Iterator
from dataclasses import dataclass, replace
from pathlib import Path
from tempfile import TemporaryDirectory

import numpy as np

ROOT = Path(__file__).resolve().parents[1]
sys.path[:0] = [str(ROOT / "benchmarks"), str(ROOT / "tests" / "oracles")]

import simulator_effects as fx  # noqa: E402  (found through the path above)
from harness import named_steps  # noqa: E402
from other_cases import predicted  # noqa: E402
from simulator import probe, run_text  # noqa: E402
from simulator_case import Ordinary, read_back, visible_size  # noqa: E402
from simulator_experiment import MACHINES, STATED_NOISE, random_experiment  # noqa: E402

from matstd.diagnosis.answer import Diagnosis, diagnose  # noqa: E402
from matstd.diagnosis.search import follows_driver  # noqa: E402
from matstd.twin.files import read_run  # noqa: E402
from matstd.twin.units import UM  # noqa: E402

VISIBLE = 12.0, 40.0  # signal to noise of the hidden effects beside the geometric model
WORSE = 1.05  # error over that without any effect from which a prediction is worse

SENSORS = ("ambient", "scaleX", "scaleY", "scaleZ", "spindle", "artefact")


@dataclass(frozen=True)
class Case:
    """Texts of two runs of one machine, and what drives the effect that it hides."""

    name: str
    truth: str
    driver: str
    machine: str
    run: str
    second: str


@dataclass(frozen=True)
class Outcome:
    """A diagnosis and what it predicts of the second run, µm."""

    result: Diagnosis
    plain: float
    named: float

    @property
    def names(self) -> list[str]:
        return [s.effect.name for s in named_steps(self.result) if s.effect is not None]

    @property
    def sensors(self) -> list[str]:
        """Names that follow a recorded driver."""
        return [e.name for e in self.result.found if follows_driver(e)]

    @property
    def is_worse(self) -> bool:
        return self.named > WORSE * self.plain


def column(driver: str) -> str:
    return driver if driver == "spindle_rpm" else f"T_{driver}_degC"


def without_column(text: str, name: str) -> str:
    """A run file without one column."""
    lines = text.splitlines()
    head = [line for line in lines if line.startswith("#")]
    rows = list(csv.reader(line for line in lines if not line.startswith("#")))
    gone = rows[0].index(name)
    out = io.StringIO()
    csv.writer(out, lineterminator="\n").writerows([r[:gone] + r[gone + 1 :] for r in rows])
    return "\n".join([*head, out.getvalue()])


def driven(rng: np.random.Generator, machine) -> tuple[object, str]:
    """A random effect that follows a sensor, and which."""
    linear, axes = machine.linear, machine.programmed
    minutes = float(rng.uniform(10.0, 40.0))
    kind = rng.choice(["scale", "standard", "lag", "speed"])
    if kind == "scale":
        axis = str(rng.choice(linear))
        return fx.scale_growth(axis, f"scale{axis}"), f"scale{axis}"
    if kind == "standard":
        return fx.growth_of_standard("artefact"), "artefact"
    letters = "XYZ" if rng.uniform() < 0.7 else "ABC"
    component = f"E{rng.choice(list(letters))}{rng.choice(axes)}"
    if kind == "speed":
        return fx.after_speed(component, minutes), "spindle_rpm"
    sensor = str(rng.choice(SENSORS))
    return fx.after_sensor(component, sensor, minutes), sensor


def simulated(index: int, seed: int) -> Case:
    rng = np.random.default_rng([seed, index])
    label = str(rng.choice(list(MACHINES), p=(0.5, 0.25, 0.25)))
    e = random_experiment(rng, label)
    speed = True
    plain = probe(e, [], np.zeros(len(e.time)))
    ordinary = Ordinary(read_back(run_text(e, plain, speed), MACHINES[label]).touches)
    while True:
        effect, driver = driven(rng, e.machine)
        per_unit, _ = visible_size(e, effect, ordinary, STATED_NOISE)
        size = rng.uniform(*VISIBLE) / max(per_unit, 1e-9)
        if size <= effect.largest:
            break
    effect.amplitude = size
    other = replace(random_experiment(rng, label), errors=e.errors)
    texts = [
        run_text(one, probe(one, [effect], rng.normal(0.0, STATED_NOISE, len(one.time))), speed)
        for one in (e, other)
    ]
    return Case(f"{label}{index}", effect.name, driver, MACHINES[label], *texts)


def stored(folder: Path) -> Case | None:
    """A case of another simulator; None where nothing hidden follows a sensor."""
    hidden = json.loads((folder / "truth.json").read_text())["hidden"]
    drivers = {v.removeprefix("T_") for h in hidden for v in h["vars"] if v.startswith("T_")}
    drivers |= {v for h in hidden for v in h["vars"] if v == "spindle_rpm"}
    if not drivers:
        return None
    text = (folder / "run.csv").read_text()
    return Case(
        folder.name,
        ", ".join(h["name"] for h in hidden),
        drivers.pop(),
        (folder / "machine.toml").read_text(),
        text,
        (folder / "second" / "run.csv").read_text(),
    )


def outcome(case: Case, cut: Callable[[str], str]) -> Outcome:
    """Diagnosis of a case whose run files were cut."""
    with TemporaryDirectory() as folder:
        here = Path(folder)
        (here / "machine.toml").write_text(case.machine)
        (here / "run.csv").write_text(cut(case.run))
        (here / "second.csv").write_text(cut(case.second))
        result = diagnose(read_run(here / "run.csv"))
        plain = predicted(result.start, here / "second.csv").rms / UM
        named = predicted(result.predicting, here / "second.csv").rms / UM
    return Outcome(result, plain, named)


def cases(args: argparse.Namespace) -> Iterator[Case]:
    for folder in args.folders:
        case = stored(folder)
        if case is not None:
            yield case
    for index in range(args.first, args.first + args.n):
        yield simulated(index, args.seed)


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("folders", nargs="*", type=Path)
    parser.add_argument("-n", type=int, default=24, help="number of simulated cases")
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--first", type=int, default=0, help="number of the first case")
    whole, cut = [], []
    args = parser.parse_args()
    for case in cases(args):
        name = column(case.driver)
        one = outcome(case, lambda text: text)
        two = outcome(case, lambda text, name=name: without_column(text, name))
        whole.append(bool(one.sensors))
        cut.append(two)
        mark = "FALSE" if two.sensors else "WORSE" if two.is_worse else "ok   "
        print(
            f"{mark} {case.name:10} {case.truth:30} recorded: {one.named:5.2f} of {one.plain:5.2f}"
            f"  {', '.join(one.names) or '-':40}  without: {two.named:5.2f} of {two.plain:5.2f}  "
            f"{two.result.verdict.value:17} {', '.join(two.names) or '-'}",
            flush=True,
        )
    print(f"\nrecorded: a sensor's law is named in {sum(whole)} of {len(whole)}")
    print(f"deleted: another sensor is named in {sum(bool(c.sensors) for c in cut)} of {len(cut)}")
    print(f"deleted: predicts worse than no effect in {sum(c.is_worse for c in cut)} of {len(cut)}")


if __name__ == "__main__":
    main()
