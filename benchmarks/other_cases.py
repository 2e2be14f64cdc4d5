"""Scores the diagnosis on cases of another simulator, and its promise on a second run of each.

    python benchmarks/other_cases.py DIR [DIR ...]

A DIR is a case: run.csv, machine.toml, truth.json and second/ (the same machine and effect at other
places), or a folder of such cases. Right means: every hidden effect is named, as itself or in its
class, and nothing else is; where nothing is hidden, nothing is named and nothing is left. The
promise is right if the error at the second run is 0.8 to 1.25 times the promised one.
"""

import json
import time
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from harness import cases, listed, mark, named_steps, names_of, parser_of

from matstd.diagnosis.answer import Comparison, Diagnosis, Step, Verdict, compare, diagnose
from matstd.diagnosis.fit import Fit, Prior
from matstd.twin.files import read_run
from matstd.twin.model import Model
from matstd.twin.units import UM

PROMISE = 0.8, 1.25  # least and largest error at other places over the promised one


OF_FIRST = ("artefact-slip", "artefact-jump")  # kinds of effects that belong to the first run alone


@dataclass(frozen=True)
class Score:
    """What came out of one case; errors in µm."""

    name: str
    truth: str
    verdict: str
    found: str
    noise: float
    promised: float
    elsewhere: float
    seconds: float
    is_right: bool

    @property
    def ratio(self) -> float:
        return self.elsewhere / self.promised

    @property
    def is_kept(self) -> bool:
        return PROMISE[0] <= self.ratio <= PROMISE[1]


def words(name: str) -> list[str]:
    """Kind and arguments of an effect's name, without the point of a grid or a copy's mark."""
    kind, _, inside = name.partition("(")
    return [kind.strip("~ "), *inside.rstrip(")").replace(" ", "").split(",")]


def matches(step: Step, hidden: dict[str, Any]) -> bool:
    """Whether a named effect, or one of its class, is the hidden one."""
    wanted = [w for w in words(hidden["name"]) if w]
    return any(all(w in " ".join(words(name)) for w in wanted) for name in names_of(step))


def is_right(result: Diagnosis, hidden: list[dict[str, Any]]) -> bool:
    steps = named_steps(result)
    if not hidden:
        return not steps and result.verdict in (Verdict.NONE, Verdict.UNDECIDED)
    left = list(hidden)
    for step in steps:
        match = next((h for h in left if matches(step, h)), None)
        if match is None:
            return False
        left.remove(match)
    return not left and result.verdict is Verdict.MISSING


def score(folder: Path) -> Score:
    truth = json.loads((folder / "truth.json").read_text())
    hidden = truth["hidden"]
    began = time.process_time()
    result = diagnose(read_run(folder / "run.csv"), rng=np.random.default_rng(0))
    seconds = time.process_time() - began
    second = predicted(result.predicting, folder / "second" / "run.csv")
    return Score(
        name=folder.name,
        truth=", ".join(h["name"] for h in hidden) or "-",
        verdict=result.verdict.value,
        found=listed(named_steps(result)) or "-",
        noise=truth["sigma_um"],
        promised=result.promise.elsewhere / UM,
        elsewhere=second.rms / UM,
        seconds=seconds,
        is_right=is_right(result, hidden),
    )


def predicted(fit: Fit, path: Path) -> Comparison:
    """The second run as the fit predicts it: the same probe and drift, but no slip."""
    m = len(fit.model.parameters)
    kept = np.array([e.kind not in OF_FIRST for e in fit.model.effects for _ in e.parameters])
    effects = tuple(e for e in fit.model.effects if e.kind not in OF_FIRST)
    spread = fit.covariance[:m, :m][np.ix_(kept, kept)]
    estimates = Prior.of_estimates(fit.theta[:m][kept], spread)
    return compare(read_run(path), Model(fit.model.chain, effects), estimates)


def show(s: Score) -> None:
    print(
        f"{mark(s.is_right)} {s.name:8} {s.seconds:5.1f} s  "
        f"noise {s.noise:5.2f}  "
        f"promised {s.promised:6.2f}, second run {s.elsewhere:6.2f} ({s.ratio:4.2f}"
        f"{'' if s.is_kept else ' !'})  {s.verdict:17} {s.truth}  ->  {s.found}",
        flush=True,
    )


def main() -> None:
    parser = parser_of(__doc__)
    parser.add_argument("folders", nargs="+", type=Path)
    args = parser.parse_args()
    scores = []
    for folder in cases(args.folders, needed="second"):
        scores.append(score(folder))
        show(scores[-1])
    empty = [s for s in scores if s.truth == "-"]
    alarms = sum(not s.is_right for s in empty)
    print(f"\nright {sum(s.is_right for s in scores)} of {len(scores)}; ", end="")
    print(f"false names or remainders {alarms} of {len(empty)} with nothing hidden")
    ratios = np.array([s.ratio for s in scores])
    print(
        f"promise kept in {sum(s.is_kept for s in scores)} of {len(scores)}; second run over "
        f"promise: median {np.median(ratios):.2f}, {ratios.min():.2f} to {ratios.max():.2f}"
    )


if __name__ == "__main__":
    main()
