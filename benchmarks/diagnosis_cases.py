"""Scores the diagnosis on folders of cases with known answers: verdicts, sizes, coverage, time.

    python benchmarks/diagnosis_cases.py DIR [DIR ...] [--jobs 2] [--quiet]

A DIR is a case (run.csv, machine.toml, truth.json) or a folder of cases. Right means: nothing found
where nothing detectable is hidden; every detectable effect, or one alike, found and nothing else;
`unexplained` where the effect is outside the library.
"""

import json
import os
import platform
import resource
import time
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import numpy as np
from harness import alike_names, cases, in_processes, listed, mark, named_steps, names_of, parser_of

import matstd.diagnosis.answer.run_diagnosis as diagnosing
from matstd.diagnosis.answer import Diagnosis, Step, Verdict
from matstd.twin.files import read_run
from matstd.twin.units import UM

HALF_WIDTH = 1.96
"""Standard uncertainties to either side of an estimate that make its 95 % interval."""


@dataclass
class Score:
    """What came out of one case."""

    name: str
    truth: str
    verdict: str
    found: str
    right: bool
    seconds: float
    test_ratio: float
    sizes: list[tuple[str, float, float, float]] = field(default_factory=list)

    @property
    def is_empty(self) -> bool:
        return self.truth == "-"


def matches(step: Step, hidden: dict[str, Any]) -> bool:
    """Whether a found effect, or its class, is a hidden one or one alike."""
    assert step.effect is not None
    return step.effect.name in alike_names(hidden) or hidden["effect"] in names_of(step)


def is_right(result: Diagnosis, hidden: list[dict[str, Any]]) -> bool:
    found = named_steps(result)
    if any(h["effect"].startswith("?") and h["detectable"] for h in hidden):
        return result.verdict is Verdict.UNEXPLAINED and not found
    wanted = [h for h in hidden if h["detectable"]]
    if not wanted:
        return result.verdict is Verdict.NONE and not found
    if result.verdict is not Verdict.MISSING:
        return False
    left = list(wanted)
    for step in found:
        match = next((h for h in left if matches(step, h)), None)
        if match is not None:
            left.remove(match)
        elif not any(matches(step, h) for h in hidden if not h["detectable"]):
            return False
    return not left


def sizes(result: Diagnosis, hidden: list[dict[str, Any]]) -> list[tuple[str, float, float, float]]:
    """Name, true amplitude, estimate and uncertainty of every effect that was named exactly."""
    out = []
    for h in hidden:
        step = next((s for s in result.steps if s.effect and s.effect.name == h["effect"]), None)
        size = (
            None
            if step is None
            else next((r for r in step.reported if r.name.startswith("amplitude")), None)
        )
        if size is not None and size.u is not None:
            out.append((h["effect"], float(h["amplitude"]), size.value, size.u))
    return out


def score(folder: Path) -> Score:
    truth = json.loads((folder / "truth.json").read_text())
    hidden = truth["hidden"]
    began = time.perf_counter()
    run = read_run(folder / "run.csv")
    result = diagnosing.diagnose(run, rng=np.random.default_rng(0))
    seconds = time.perf_counter() - began
    stated = ", ".join(
        f"{h['effect']}[{h['signal_to_noise']:.0f}]" + ("" if h["detectable"] else "(below)")
        for h in hidden
    )
    ratio = result.fit.standardised_test_rms / UM / truth["noise_um"]
    return Score(
        folder.name,
        stated or "-",
        result.verdict.value,
        listed(named_steps(result)) or "-",
        is_right(result, hidden),
        seconds,
        ratio,
        sizes(result, hidden),
    )


def show(scores: list[Score], only_wrong: bool) -> None:
    for s in scores:
        if only_wrong and s.right:
            continue
        print(
            f"{mark(s.right)} {s.name:10} {s.seconds:5.1f} s  "
            f"held-out/noise {s.test_ratio:5.3f}  {s.verdict:17} {s.truth}  ->  {s.found}"
        )
        for name, true, value, u in s.sizes:
            z = (abs(value) - abs(true)) / u
            print(f"        {name}: true {true:.4g}, found {value:.4g} ± {u:.2g}  ({z:+.1f} u)")
    print()
    empty = [s for s in scores if s.is_empty]
    alarms = sum(not s.right for s in empty)
    explained = [s for s in scores if s.right and s.verdict != Verdict.UNEXPLAINED.value]
    z = np.array([(abs(v) - abs(t)) / u for s in scores if s.right for _, t, v, u in s.sizes])
    print(
        f"right {sum(s.right for s in scores)} of {len(scores)};  false alarms {alarms} of "
        f"{len(empty)} with nothing hidden"
    )
    if len(z):
        inside = np.abs(z) < HALF_WIDTH
        print(
            f"true size inside its 95 % interval: {inside.sum()} of {len(z)} "
            f"({100 * inside.mean():.1f} %); rms of (found - true)/u {np.sqrt((z**2).mean()):.2f}"
        )
    if explained:
        ratio = np.array([s.test_ratio for s in explained])
        print(
            f"held-out RMS over noise: mean {ratio.mean():.3f}, "
            f"{np.mean(abs(ratio - 1) < 0.05):.0%} within 5 %, "
            f"worst {ratio[np.argmax(abs(ratio - 1))]:.3f}"
        )
    seconds = np.array([s.seconds for s in scores])
    print(
        f"time per case: median {np.median(seconds):.2f} s, longest {seconds.max():.2f} s;  "
        f"peak memory {peak():.2f} GiB"
    )


def peak() -> float:
    """Largest memory of this process and its workers, GiB."""
    own = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss
    return max(own, resource.getrusage(resource.RUSAGE_CHILDREN).ru_maxrss) / 2**20


def main() -> None:
    parser = parser_of(__doc__)
    parser.add_argument("folders", nargs="+", type=Path)
    parser.add_argument("--jobs", type=int, default=1)
    parser.add_argument("--wrong", action="store_true", help="print only what is wrong")
    args = parser.parse_args()
    found = cases(args.folders)
    print(
        f"{len(found)} cases; Python {platform.python_version()}, numpy {np.__version__}, "
        f"{os.cpu_count()} cores, {platform.machine()}\n"
    )
    scores = in_processes(score, found, args.jobs)
    show(scores, args.wrong)


if __name__ == "__main__":
    main()
