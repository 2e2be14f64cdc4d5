"""Scores `matstd learn` on cases with a law outside the library: carrier, variables, second run.

    python benchmarks/learn_cases.py DIR [DIR ...]          folders of cases: run.csv, run_test.csv
    python benchmarks/learn_cases.py --make 17 --seed 1     exactly simulated, a family each
    python benchmarks/learn_cases.py --two 8 --seed 1       two laws at once
    python benchmarks/learn_cases.py --further 20 --seed 5  families that the learner never saw
    python benchmarks/learn_cases.py --outside 36 --seed 5  those without a formula in the grammar
    python benchmarks/learn_cases.py --surfaces 18 --seed 1 functions of two readings, later ones
    python benchmarks/learn_cases.py --deleted 8 --seed 1   an effect whose driver is not recorded
    python benchmarks/learn_cases.py --empty 20 --seed 1    nothing hidden: no law may be found

Laws that follow a clock which no column records meet the second run at another time; `--same-clock`
gives them the time of the first. They are counted apart: a prediction without them is right.
`compare` applies such a law where the touches of the second run show it; what that leaves is the
last of four errors.

The second run is judged with the set-ups and the ordinary model refitted there: what the learnt law
leaves of it, against what is left without any law and what the true law leaves (of simulated cases
the same run without the law; else the stated noise).
"""

import json
import tempfile
import time
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

import numpy as np
from deleted_driver import column, simulated, without_column
from harness import cases, parser_of  # puts the simulator on the path
from simulator_case import Ordinary
from simulator_experiment import MACHINES
from simulator_further_laws import FURTHER, OUTSIDE, SURFACES
from simulator_laws import FAMILIES, law_case

from matstd.diagnosis.files import model_text, parsed_model
from matstd.diagnosis.laws import POLICY, Learning, LearntLaw, learn_laws
from matstd.twin.files import read_run
from matstd.twin.laws import Law, carrier_of, law_of
from matstd.twin.record import Run, without_copies
from matstd.twin.units import UM

DELETED = "deleted"  # family of effects whose driver is not recorded

WITHIN, WORSE, ALIKE = 1.1, 1.02, 0.999
"""Ratio to the error of the true law that is right, and to that without a law that is worse; cosine
of carriers that are one class."""


@dataclass
class Score:
    """What came out of one case."""

    name: str
    truth: str
    found: str
    carrier: bool
    in_class: bool  # or that of a law which the run does not distinguish, over which it predicts
    variables: bool
    family: bool
    none: float
    learnt: float
    true: float
    seconds: float
    compared: float
    is_clocked: bool = False

    @property
    def is_predicted(self) -> bool:
        return self.learnt < WITHIN * self.true

    @property
    def is_worse(self) -> bool:
        return self.learnt > WORSE * self.none

    @property
    def is_half(self) -> bool:
        return self.learnt**2 - self.true**2 < 0.5 * (self.none**2 - self.true**2)

    @property
    def as_compared(self) -> "Score":
        """With the laws that `compare` applies to the second run."""
        return replace(self, learnt=self.compared)


def left_of(run: Run, deviation: np.ndarray, ordinary: Ordinary) -> float:
    """Root mean square that no ordinary model with free set-ups explains, µm."""
    left = ordinary.left(deviation)
    return float(np.sqrt(left @ left / (len(run) - ordinary.rank))) / UM


def variable(name: str) -> str:
    """A variable of a truth as laws name it."""
    return name.replace("_", "-", 1)


def is_right(found: Learning, hidden: dict[str, Any], one: LearntLaw) -> tuple[bool, ...]:
    """Whether carrier, class of the carrier, variables and family are those of a hidden law."""
    law = one.law
    members = [own for effect, _ in one.members(POLICY) if (own := law_of(effect)) is not None]
    families = hidden.get("shapes") or [hidden.get("shape", "")]
    family = "*".join(sorted(f.shape.word for f in law.factors))
    alike = [hidden["carrier"], *(a[0] for a in hidden.get("carriers_alike", []))]
    return (
        any(is_alike(found, law, name) for name in alike),
        any(is_alike(found, member, name) for member in members for name in alike),
        {f.driver.name for f in law.factors} == {variable(v) for v in hidden["variables"]},
        family in ["*".join(sorted(words.split("*"))) for words in families],
    )


def is_alike(found: Learning, law: Law, name: str) -> bool:
    """Whether the carrier of a law does what another one does at every touch."""
    touches = found.before.run.touches
    if name.startswith("shift") and law.carrier.name.startswith("shift"):
        return True
    try:
        hidden = carrier_of(name, touches.chain).columns(touches)
    except (LookupError, ValueError):
        return False
    own = law.carrier.columns(touches)
    if hidden.shape != own.shape:
        return False
    size = np.linalg.norm(own) * np.linalg.norm(hidden)
    return bool(abs(float((own * hidden).sum())) > ALIKE * size)


def score(folder: Path) -> Score:
    truth = json.loads((folder / "truth.json").read_text())
    run, second = (without_copies(read_run(folder / f)) for f in ("run.csv", "run_test.csv"))
    began = time.process_time()
    found = learn_laws(run)
    seconds = time.process_time() - began
    ordinary = Ordinary(second.touches)
    none = left_of(second, second.deviation, ordinary)
    learnt = left_of(second, second.deviation - found.predicted(second), ordinary)
    saved = parsed_model(model_text(found.saved, "run.csv"), "model.toml", runs=[second])
    base = {effect.name for effect in found.before.model.effects}  # else a law or one of its class
    own = np.array([effect.name not in base for effect, _ in saved.model.parameters])
    laws = saved.model.columns(second.touches)[:, own] @ saved.estimates.mean[own]
    compared = left_of(second, second.deviation - laws, ordinary)
    free = folder / "run_test_free.csv"
    true = truth["noise_um"]
    if free.exists():
        plain = without_copies(read_run(free))
        true = left_of(plain, plain.deviation, Ordinary(plain.touches))
    hidden = truth["hidden"]
    names = [one.law.name for one in found.laws]
    right = [not names] * 4
    if hidden:  # each hidden law is right if a learnt one is
        each = [[is_right(found, law, one) for one in found.laws] for law in hidden]
        best = [max(marks, default=(False,) * 4) for marks in each]
        right = [all(marks) for marks in zip(*best, strict=True)]
    planted = " + ".join(f"{law['family']} {law['carrier']}" for law in hidden) or "-"
    law_names = ", ".join(names) or "-"
    is_clocked = any(law.get("clocked", False) for law in hidden)
    return Score(
        folder.name, planted, law_names, *right, none, learnt, true, seconds, compared, is_clocked
    )


def make(
    families: list[str | None], seed: int, into: Path, is_clock_kept: bool = False
) -> list[Path]:
    """Simulated cases, a machine after the other."""
    out = []
    for i, family in enumerate(families):
        label = list(MACHINES)[(seed + i) % len(MACHINES)]
        if {"harmonic_by_direction", "half_wave", "overshoot"} & set((family or "").split("+")):
            label = "hsm600u"
        try:
            rng = np.random.default_rng([seed, i])
            texts = law_case(rng, label, family, is_clock_kept=is_clock_kept)
        except ValueError as invisible:  # a power law over a short travel
            print(f"left out: {invisible}")
            continue
        folder = into / f"{family or 'empty'}_{label}_{i}"
        folder.mkdir(parents=True)
        for name, text in zip(("run", "run_test", "run_test_free"), texts, strict=False):
            (folder / f"{name}.csv").write_text(text)
        (folder / "machine.toml").write_text(MACHINES[label])
        (folder / "truth.json").write_text(json.dumps(texts[3]))
        out.append(folder)
    return out


def make_deleted(count: int, seed: int, into: Path) -> list[Path]:
    """Simulated cases whose effect follows a driver that neither run records."""
    out = []
    for i in range(count):
        case = simulated(i, seed)
        folder = into / f"deleted_{case.name}"
        folder.mkdir(parents=True)
        for name, text in (("run", case.run), ("run_test", case.second)):
            cut = without_column(text, column(case.driver))
            (folder / f"{name}.csv").write_text(cut)
        (folder / "machine.toml").write_text(case.machine)
        hidden = {"family": DELETED, "carrier": case.truth, "variables": [case.driver]}
        (folder / "truth.json").write_text(json.dumps({"hidden": [hidden], "noise_um": 0.6}))
        out.append(folder)
    return out


def show(one: Score) -> None:
    right = (one.carrier, one.in_class, one.variables, one.family)
    marks = "".join(m if ok else "-" for m, ok in zip("CcVF", right, strict=True))
    verdict = "ok" if one.is_predicted else "half" if one.is_half else "poor"
    verdict = "clock" if one.is_clocked else verdict
    verdict = "WORSE" if one.is_worse else verdict
    print(
        f"{one.name:32} {marks} {verdict:5} none {one.none:6.2f} learnt {one.learnt:6.2f} "
        f"true {one.true:5.2f} compared {one.compared:6.2f} µm {one.seconds:5.1f} s  "
        f"{one.truth} -> {one.found}",
        flush=True,
    )


def counted(laws: list[Score]) -> str:
    """What of some laws is right."""
    others = [s for s in laws if not s.is_clocked]
    counts = {
        "carrier": sum(s.carrier for s in laws),
        "in its class": sum(s.in_class for s in laws),
        "variables": sum(s.variables for s in laws),
        "family": sum(s.family for s in laws),
        f"of {len(others)} without a clock second run within 10 %": sum(
            s.is_predicted for s in others
        ),
        "half of the excess": sum(s.is_half for s in others),
        "worse than none": sum(s.is_worse for s in laws),
        f"as compared, of {len(laws)} within 10 %": sum(s.as_compared.is_predicted for s in laws),
        "half": sum(s.as_compared.is_half for s in laws),
        "worse": sum(s.as_compared.is_worse for s in laws),
    }
    return f"{len(laws)} laws: {', '.join(f'{name} {n}' for name, n in counts.items())}"


def main() -> None:
    parser = parser_of(__doc__)
    parser.add_argument("folders", nargs="*", type=Path)
    parser.add_argument("--make", type=int, default=0, help="number of simulated cases")
    parser.add_argument("--two", type=int, default=0, help="number of cases with two laws at once")
    parser.add_argument("--further", type=int, default=0, help="number of cases of other families")
    parser.add_argument("--outside", type=int, default=0, help="number without a formula")
    parser.add_argument("--surfaces", type=int, default=0, help="number of further surfaces")
    parser.add_argument("--deleted", type=int, default=0, help="number without their driver")
    parser.add_argument("--empty", type=int, default=0, help="number of cases with nothing hidden")
    parser.add_argument("--same-clock", action="store_true", help="clocks show the same times")
    parser.add_argument("--seed", type=int, default=1)
    a = parser.parse_args()
    with tempfile.TemporaryDirectory() as scratch:
        folders = cases(a.folders, needed="run_test.csv")
        named = [FAMILIES[i % len(FAMILIES)] for i in range(a.make)]
        pairs = [f"{FAMILIES[(5 * i) % 17]}+{FAMILIES[(5 * i + 8) % 17]}" for i in range(a.two)]
        other = [FURTHER[i % len(FURTHER)] for i in range(a.further)]
        # each turn begins one later, so that a family meets every machine
        for families, count in ((OUTSIDE, a.outside), (SURFACES, a.surfaces)):
            other += [families[(i + i // len(families)) % len(families)] for i in range(count)]
        folders += make(
            [*named, *pairs, *other, *[None] * a.empty], a.seed, Path(scratch), a.same_clock
        )
        folders += make_deleted(a.deleted, a.seed, Path(scratch))
        scores = []
        for folder in folders:
            scores.append(score(folder))
            show(scores[-1])
    planted = {s.name: s.truth.split(" ")[0] for s in scores}
    outside = [s for s in scores if planted[s.name] in (*OUTSIDE, *SURFACES)]
    deleted = [s for s in scores if planted[s.name] == DELETED]
    laws = [s for s in scores if s.truth != "-" and s not in (*outside, *deleted)]
    empty = [s for s in scores if s.truth == "-"]
    seconds = [s.seconds for s in scores]
    print(
        f"{counted(laws)}; outside the grammar {counted(outside)}; without their driver "
        f"{len(deleted)}: worse than none {sum(s.is_worse for s in deleted)}, as compared "
        f"{sum(s.as_compared.is_worse for s in deleted)}; false "
        f"laws in {sum(s.found != '-' for s in empty)} of {len(empty)} empty runs; processor "
        f"{np.median(seconds):.1f} s, at most {max(seconds):.1f} s"
    )


if __name__ == "__main__":
    main()
