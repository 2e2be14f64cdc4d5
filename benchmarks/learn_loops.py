"""Closes the loop of learning: run, learn, plan the next visit, make it, learn from both.

    python benchmarks/learn_loops.py 50 --seed 1

Runs are short and faint (some 250 touches, signal to noise 8 to 25), so that several laws explain
them. Planned visits are made on the exact simulator, which knows the law by its own formula, clamps
the standard anew and has weather of its own. Decided: the law of the right carrier and variables
has odds of 20 : 1 against every law of another carrier or other variables; carriers that do the
same at every touch are one, and so are laws that do the same at every touch that a visit can make.
"""

import time
from collections.abc import Sequence
from typing import Any

import numpy as np
from harness import parser_of  # puts the simulator on the path
from learn_cases import is_alike, variable
from simulator import probe, run_text
from simulator_case import Ordinary, read_back
from simulator_experiment import MACHINES, STATED_NOISE, Experiment, random_experiment
from simulator_laws import FAMILIES, drawn
from simulator_visit import visit

from matstd.diagnosis.laws import Learning, learn_laws
from matstd.diagnosis.next_visit import DECIDED, VisitPlan, plan_visit
from matstd.twin.model import Effect
from matstd.twin.record import Run, joined

POSES, SIGNAL_TO_NOISE, VISITS = 4, (8.0, 25.0), 2


def measured(rng: np.random.Generator, e: Experiment, hidden: Any, label: str) -> Run:
    """What the control records."""
    noise = rng.normal(0.0, STATED_NOISE, len(e.time))
    return read_back(run_text(e, probe(e, [hidden], noise), False), MACHINES[label])


def made(rng: np.random.Generator, first: Experiment, run: Run, plan: VisitPlan) -> Experiment:
    """The planned visit as an experiment of the simulator."""
    t = plan.touches
    assert t is not None
    apart = np.linalg.norm(t.point[:, None] - run.touches.point[None], axis=2)
    apart[t.feature[:, None] != run.touches.feature[None]] = np.inf
    axes = sorted(first.machine.rotary)
    pace = float(np.median(np.diff(t.time)))
    stop = np.inf
    if plan.pause_after is not None:
        stop = float(t.time[plan.pause_after - 1]) + pace
    return visit(
        rng,
        first,
        np.argmin(apart, axis=1),
        [stated(s.T_table_artefact) for s in t.setups],
        t.setup,
        {a: t.reading(a) for a in axes},
        {a: t.last_move(a) for a in axes},
        t.time,
        (plan.schedule.warm_up, stop, plan.schedule.pause),
    )


def stated(T: np.ndarray) -> tuple[np.ndarray, float]:
    """Origin and turn about z of a planned set-up."""
    return T[:3, 3], float(np.arctan2(T[1, 0], T[0, 0]))


def decided(
    found: Learning, truth: dict[str, Any], alike: Sequence[Effect] = ()
) -> tuple[bool, float, float]:
    """Whether a law is the hidden one; odds against other carriers or variables, and shapes.

    Args:
        alike: What does the same at every touch that can be made: one class with the law.
    """
    own, same = {variable(v) for v in truth["variables"]}, {effect.name for effect in alike}

    def is_right(law: Any) -> bool:
        names = {f.driver.name for f in law.factors}
        return names == own and is_alike(found, law, truth["carrier"])

    for one in found.laws:
        if is_right(one.law):
            others = [
                r.log_odds for r in one.rivals if not is_right(r.law) and r.law.name not in same
            ]
            shapes = [r.log_odds for r in one.rivals if r.law.name != one.law.name]
            return True, min(others, default=np.inf), min(shapes, default=np.inf)
    return False, -np.inf, -np.inf


def loop(seed: int, i: int) -> list[bool]:
    """Decided after no, one and two visits."""
    rng = np.random.default_rng([seed, i])
    label = list(MACHINES)[(seed + i) % len(MACHINES)]
    family = FAMILIES[i % len(FAMILIES)]
    label = "hsm600u" if "harmonic_by_direction" in family else label
    first = random_experiment(rng, label, POSES)
    plain = read_back(run_text(first, probe(first, [], np.zeros(len(first.time))), False),
                      MACHINES[label])  # fmt: skip
    hidden, truth = drawn(rng, first, family, SIGNAL_TO_NOISE, Ordinary(plain.touches), label)
    runs = {"run": measured(rng, first, hidden, label)}
    out, words = [], []
    began = time.process_time()
    for k in range(VISITS + 1):
        found = learn_laws(joined(runs))
        is_right, odds, shape = decided(found, truth)
        out.append(is_right and odds >= DECIDED)
        law = found.laws[0].law.name if found.laws else "-"
        words.append(f"{law} {'+' if is_right else '-'}{odds:.1f}/{shape:.1f}")
        if k == VISITS or out[-1]:
            break
        plan = plan_visit(found, rng)
        if plan.alike:
            is_right, odds, _ = decided(found, truth, plan.alike)
            words.append(f"one class with {len(plan.alike)}: {odds:.1f}")
            out[-1] = is_right and odds >= DECIDED
        if out[-1]:
            break
        if plan.touches is None:
            words.append(plan.refusal.name if plan.refusal else "")
            break
        n = sum(r.is_distinguished for r in plan.rivals)
        words.append(f"[{n} of {len(plan.rivals)} rivals, power {plan.power or 0.0:.2f}]")
        experiment = made(rng, first, runs["run"], plan)
        runs[f"visit{k + 1}"] = measured(rng, experiment, hidden, label)
    out += [out[-1]] * (VISITS + 1 - len(out))
    print(f"{i:3} {family:22} {truth['carrier']:5} {label:8} {time.process_time() - began:5.1f} s  "
          f"{' -> '.join(words)}", flush=True)  # fmt: skip
    return out


def main() -> None:
    parser = parser_of(__doc__)
    parser.add_argument("loops", type=int, help="number of loops")
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--first", type=int, default=0, help="number of the first loop")
    a = parser.parse_args()
    marks = []
    for i in range(a.first, a.first + a.loops):
        try:
            marks.append(loop(a.seed, i))
        except ValueError as invisible:
            print(f"{i:3} left out: {invisible}", flush=True)
    counts = np.sum(marks or [[False] * (VISITS + 1)], axis=0)
    print(f"{len(marks)} loops: decided by the run {counts[0]}, after one visit {counts[1]}, "
          f"after two {counts[2]}")  # fmt: skip


if __name__ == "__main__":
    main()
