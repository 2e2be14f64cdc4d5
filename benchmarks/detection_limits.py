"""How often an effect of the size that is reported as the smallest detectable one is found.

    python benchmarks/detection_limits.py [--runs 60] [--first 0] [--jobs 1] [--seed 1]

Three machines with nothing hidden are diagnosed; each report states the smallest size of every
effect that the same touches would have shown. Then one of those effects acts on the same machine at
the same touches, exactly simulated by its own formula with its inner parameters and the noise drawn
anew, at that size. It is found if it is named, or an effect that does nearly the same; by its
statement in four of five runs.
"""

from functools import cache

import numpy as np
from harness import MACHINES, in_processes, mark, named_steps, names_of, run_options
from simulator import probe, run_text
from simulator_case import ALIKE, Ordinary, named, read_back, visible_size
from simulator_experiment import MACHINES as FILES
from simulator_experiment import STATED_NOISE, Experiment, random_experiment

from matstd.diagnosis.answer import Detectable, diagnose

KINDS = (
    "artefact-expansion", "backlash", "coupling", "periodic", "probe-lobing", "stylus-bending",
    "thermal-expansion", "thermal-lag",
)  # fmt: skip
"""Kinds that the simulator has a formula of."""

UNITS = {"mm": 1e-3, "mm/K": 1e-3, "rad": 1e-6, "rad/K": 1e-6, "1/K": 1e-6}
"""Base units of a size, and what an amplitude of 1 of the simulator is in them."""


@cache
def nothing_hidden(seed: int, number: int) -> tuple[Experiment, Ordinary, list[Detectable]]:
    """A machine at its touches, and what they would have shown."""
    rng = np.random.default_rng([seed, number])
    label = MACHINES[number]
    e = random_experiment(rng, label)
    text = run_text(e, probe(e, [], rng.normal(0.0, STATED_NOISE, len(e.time))), False)
    run = read_back(text, FILES[label])
    limits = [
        d
        for d in diagnose(run).detectable
        if d.size is not None and d.effect.kind in KINDS and "spindle_rpm" not in d.effect.name
    ]
    return e, Ordinary(run.touches), limits


def one(job: tuple[int, int]) -> bool:
    """Whether one effect at its stated size is found."""
    seed, index = job
    e, ordinary, limits = nothing_hidden(seed, index % len(MACHINES))
    rng = np.random.default_rng([seed, 1000 + index])
    while True:
        kind = rng.choice(sorted({d.effect.kind for d in limits}))
        limit = rng.choice([d for d in limits if d.effect.kind == kind])
        hidden = named(rng, e.machine, limit.effect.name)
        _, signature = visible_size(e, hidden, ordinary, STATED_NOISE)
        hidden.amplitude = limit.size / UNITS[limit.unit]
        if hidden.amplitude < hidden.largest:
            break
    noise = rng.normal(0.0, STATED_NOISE, len(e.time))
    result = diagnose(read_back(run_text(e, probe(e, [hidden], noise), False), FILES[e.label]))
    names = set().union(*map(names_of, named_steps(result)))
    is_found = limit.effect.name in names
    if names and not is_found:
        alike = {r[1] for r in ordinary.alike(signature, limit.effect.name) if r[0] > ALIKE}
        is_found = bool(alike & names)
    print(
        f"{mark(is_found)} {e.label:8} {limit.effect.name} {limit.size:.3g} {limit.unit}: "
        f"{result.verdict.value}: {', '.join(sorted(names)[:4]) or '-'}",
        flush=True,
    )
    return is_found


def main() -> None:
    parser = run_options(__doc__, 60)
    parser.add_argument("--seed", type=int, default=1)
    args = parser.parse_args()
    jobs = [(args.seed, k) for k in range(args.first, args.first + args.runs)]
    found = in_processes(one, jobs, args.jobs)
    share = float(np.mean(found))
    u = np.sqrt(share * (1.0 - share) / len(found))
    print(
        f"\nfound {sum(found)} of {len(found)}: {100 * share:.0f} ± {100 * u:.0f} % (stated: 80 %)"
    )


if __name__ == "__main__":
    main()
