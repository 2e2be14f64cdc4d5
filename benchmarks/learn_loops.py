"""Closes the loop of learning: run, learn, plan the next visit, make it, learn from both.

    python benchmarks/learn_loops.py 50 --seed 1

Runs are short and faint (some 250 touches, signal to noise 8 to 25), so that several laws explain
them. Planned visits are made on the exact simulator, which knows the law by its own formula, clamps
the standard anew and has weather of its own. Decided: the law of the right carrier and variables
has odds of 20 : 1 against every law of another carrier or other variables. One class are carriers
that do the same at every touch, laws that do the same at every touch that a visit can make, and,
counted apart, rivals that the longest visit separates by less than three standard deviations. A
variable is asked for only where the hidden law depends on it at touches that can be made. False: a
wrong class has these odds.
"""

import time
from collections.abc import Sequence
from dataclasses import replace
from typing import Any

import numpy as np
from harness import parser_of  # puts the simulator on the path
from learn_cases import is_alike, variable
from simulator import probe, run_text
from simulator_case import Ordinary, read_back
from simulator_effects import Hidden, State
from simulator_experiment import MACHINES, STATED_NOISE, Experiment, random_experiment
from simulator_laws import FAMILIES, drawn
from simulator_visit import visit

from matstd.diagnosis.laws import Learning, learn_laws
from matstd.diagnosis.next_visit import (
    DECIDED,
    LEAST_SEPARATION,
    VisitPlan,
    plan_visit,
    visiting_touches,
)
from matstd.twin.laws import Law, law_of
from matstd.twin.model import Effect
from matstd.twin.record import Run, Touches, joined

RUN_POSES, SIGNAL_TO_NOISE, VISITS = 4, (8.0, 25.0), 2

OFFERED = 48, 32  # poses, and touches at each, among which a variable must act


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


def inert(rng: np.random.Generator, first: Experiment, hidden: Hidden, run: Run,
          names: set[str]) -> set[str]:  # fmt: skip
    """Readings and directions on which a hidden law depends at no touch that can be made, visibly.

    Each is held at its value where the law is largest, at the touches of the run and of a visit to
    all poses that are offered: what changes is below three standard deviations by all of them.
    """
    visits = [run.touches, visiting_touches(run, *OFFERED, rng)]
    changes = dict.fromkeys(sorted(n for n in names if n.removeprefix("last-") in "XYZBC"), 0.0)
    for state in (stated_touches(first, t) for t in visits):
        whole = acted(hidden, state)
        k = int(np.argmax(np.abs(whole)))
        for name in changes:
            at = "last_move" if name.startswith("last-") else "q"
            axis = name.removeprefix("last-")
            values = dict(getattr(state, at))
            values[axis] = np.full(len(whole), values[axis][k])
            change = acted(hidden, replace(state, **{at: values})) - whole
            changes[name] += float(change @ change)
    least = (LEAST_SEPARATION * STATED_NOISE) ** 2
    return {name for name, change in changes.items() if change < least and len(names) > 1}


def acted(hidden: Hidden, state: State) -> np.ndarray:
    """What a hidden law adds to its carrier, (N,), mm or rad."""
    (one,) = hidden.act(state, hidden.amplitude).values()
    return one if one.ndim == 1 else np.linalg.norm(one, axis=1)


def stated_touches(first: Experiment, t: Touches) -> State:
    """Touches as the simulator's laws see them."""
    axes = [*first.machine.linear, *first.machine.rotary]
    return State(
        first.machine, {a: t.reading(a) for a in axes}, {a: t.last_move(a) for a in axes}, t.time,
        t.temperature, None, t.setup, None, t.point_table, t.normal_table,
    )  # fmt: skip


class Judged:
    """What was learnt against the truth, with a class of laws that no visit distinguishes."""

    def __init__(self, found: Learning, truth: dict[str, Any], same: Sequence[Effect]) -> None:
        self.found, self.carrier, self.inert = found, truth["carrier"], truth["inert"]
        self.own = {variable(v) for v in truth["variables"]} | self.inert
        self.names = {effect.name for effect in same}
        first, *_ = [*(one for one in found.laws if self.is_right(one.law)), *found.laws, None]
        beside = [law for law in map(law_of, same) if law is not None] if first else []
        self.right = first is not None and any(map(self.is_right, [first.law, *beside]))
        rivals = first.rivals if first else ()
        apart = [r for r in rivals if r.law.name not in self.names and not self.is_same(first, r)]
        self.odds = min((r.log_odds for r in apart), default=np.inf) if first else -np.inf
        shapes = (r.log_odds for r in rivals if r.law.name != first.law.name)
        self.shape = min(shapes, default=np.inf)

    def is_right(self, law: Law) -> bool:
        """Whether a law has the hidden carrier and variables."""
        names = {f.driver.name for f in law.factors}
        return names | self.inert == self.own and is_alike(self.found, law, self.carrier)

    def is_same(self, first: Any, rival: Any) -> bool:
        """Whether a rival is in the class of the law: of the hidden one, or of a wrong one."""
        if self.right:
            return self.is_right(rival.law)
        same_variables = {*rival.law.drivers} == {*first.law.drivers}
        return same_variables and is_alike(self.found, rival.law, first.law.carrier.name)

    @property
    def is_decided(self) -> bool:
        """Whether the class of the law has odds of 20 : 1 against all others."""
        return self.odds >= DECIDED


def loop(seed: int, i: int) -> tuple[list[bool], bool, bool]:
    """Decided right after no, one and two visits; whether by a class; whether decided wrongly."""
    rng = np.random.default_rng([seed, i])
    label = list(MACHINES)[(seed + i) % len(MACHINES)]
    family = FAMILIES[i % len(FAMILIES)]
    label = "hsm600u" if "harmonic_by_direction" in family else label
    first = random_experiment(rng, label, RUN_POSES)
    plain = read_back(run_text(first, probe(first, [], np.zeros(len(first.time))), False),
                      MACHINES[label])  # fmt: skip
    hidden, truth = drawn(rng, first, family, SIGNAL_TO_NOISE, Ordinary(plain.touches), label)
    runs = {"run": measured(rng, first, hidden, label)}
    own = {variable(v) for v in truth["variables"]}
    truth["inert"] = inert(np.random.default_rng(i), first, hidden, runs["run"], own)
    out, words = [], [f"({', '.join(sorted(truth['inert']))} inert)"] if truth["inert"] else []
    began = time.process_time()
    for k in range(VISITS + 1):
        found = learn_laws(joined(runs))
        plan = plan_visit(found, rng)
        is_last = plan.touches is None or k == VISITS
        # all touches come from one side, and a visit would show the law from the other
        unlikely = [r for r in plan.rivals if r.log_odds >= DECIDED and not r.is_unseen]
        is_open = not is_last and any(r.is_distinguished for r in unlikely)
        left = [one.effect for one in plan.indistinct] if is_last else []
        judged = Judged(found, truth, [*plan.alike, *left])
        is_class = judged.is_decided and not Judged(found, truth, plan.alike).is_decided
        out.append(judged.right and judged.is_decided and not is_open)
        law = found.laws[0].law.name if found.laws else "-"
        words.append(f"{law} {'+' if judged.right else '-'}{judged.odds:.1f}/{judged.shape:.1f}"
                     f"{' as a class' * is_class}")  # fmt: skip
        if is_last or (judged.is_decided and not is_open):
            words += [plan.refusal.name] if plan.refusal and not judged.is_decided else []
            break
        n = sum(r.is_distinguished for r in plan.rivals)
        words.append(f"[{len(plan.touches)} touches, {n} of {len(plan.rivals)} rivals, power "
                     f"{plan.power or 0.0:.2f}]")  # fmt: skip
        experiment = made(rng, first, runs["run"], plan)
        runs[f"visit{k + 1}"] = measured(rng, experiment, hidden, label)
    out += [out[-1]] * (VISITS + 1 - len(out))
    is_false = judged.is_decided and not judged.right
    print(f"{i:3} {family:22} {truth['carrier']:5} {label:8} {time.process_time() - began:5.1f} s  "
          f"{'FALSE ' * is_false}{' -> '.join(words)}", flush=True)  # fmt: skip
    return out, is_class and out[-1], is_false


def main() -> None:
    parser = parser_of(__doc__)
    parser.add_argument("loops", type=int, help="number of loops")
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--first", type=int, default=0, help="number of the first loop")
    a = parser.parse_args()
    marks, by_class, false = [], 0, 0
    for i in range(a.first, a.first + a.loops):
        try:
            mark, is_class, is_false = loop(a.seed, i)
        except ValueError as invisible:
            print(f"{i:3} left out: {invisible}", flush=True)
            continue
        marks.append(mark)
        by_class += is_class
        false += is_false
    counts = np.sum(marks or [[False] * (VISITS + 1)], axis=0)
    print(f"{len(marks)} loops: decided by the run {counts[0]}, after one visit {counts[1]}, "
          f"after two {counts[2]}, of these {by_class} with rivals that no visit distinguishes; "
          f"decided wrongly {false}")  # fmt: skip


if __name__ == "__main__":
    main()
