"""How often a run with nothing hidden says otherwise, and how small chance makes its best p.

    python benchmarks/false_alarms.py [--runs 60] [--first 0] [--jobs 1] [--seed 1]

Machines with ordinary errors are probed by the simulator of the tests, every touch with white noise
of the stated size, and diagnosed. An alarm is a named effect or a remainder; `Policy` allows
`false_alarm_of_run`. So rare an event takes thousands of runs to measure, so the level is measured
where it can be: of the most likely effect by itself, whose probability by chance pays for the whole
library, the share of runs below 0.5 and 0.1 must not exceed 0.5 and 0.1.
"""

import numpy as np
from harness import MACHINES, in_processes, mark, run_options
from simulator import probe, run_text
from simulator_case import read_back
from simulator_experiment import MACHINES as FILES
from simulator_experiment import STATED_NOISE, random_experiment

from matstd.diagnosis.answer import Verdict, diagnose
from matstd.diagnosis.policy import POLICY

LEVELS = 0.5, 0.1


def one(job: tuple[int, int]) -> tuple[bool, float]:
    """Whether a run with nothing hidden says otherwise, and its smallest probability by chance."""
    seed, index = job
    rng = np.random.default_rng([seed, index])
    label = MACHINES[index % len(MACHINES)]
    e = random_experiment(rng, label)
    noise = rng.normal(0.0, STATED_NOISE, len(e.time))
    result = diagnose(read_back(run_text(e, probe(e, [], noise), False), FILES[label]))
    is_alarm = result.verdict is not Verdict.NONE or bool(result.found)
    best = result.candidates[0]
    print(f"{mark(not is_alarm)} {label:8} p = {best.p_value:.2g} {best.effect}", flush=True)
    return is_alarm, best.p_value


def main() -> None:
    parser = run_options(__doc__, 60)
    parser.add_argument("--seed", type=int, default=1)
    args = parser.parse_args()
    jobs = [(args.seed, k) for k in range(args.first, args.first + args.runs)]
    alarms, chances = zip(*in_processes(one, jobs, args.jobs), strict=True)
    below = ", ".join(f"{level:g} in {sum(p < level for p in chances)}" for level in LEVELS)
    print(
        f"\nalarms in {sum(alarms)} of {len(jobs)} runs (allowed: "
        f"{POLICY.false_alarm_of_run:g} of all); smallest p below {below}"
    )


if __name__ == "__main__":
    main()
