"""Effects ten times their usual size: found, found once, with the right size?

    python benchmarks/large_effects.py [--runs 20] [--first 0] [--times 10] [--jobs 1]

Each run hides one effect in the independent exact simulator, by its own formula there, so many
times as large as the library expects it; every other run has chips, a noise that is not as stated
and a spindle that runs besides. Right is the effect, or one that the same touches cannot
distinguish from it, and nothing beside it.
"""

import time

import numpy as np
from harness import (
    MACHINES,
    alike_names,
    in_processes,
    listed,
    mark,
    named_steps,
    names_of,
    run_options,
)

SEED = 41


def drawn(rng: np.random.Generator, label: str, hard: bool):
    """A random effect of any kind that the machine can have, without its size."""
    from simulator_draw import draw
    from simulator_experiment import MACHINES as FILES
    from simulator_machine import read_machine

    return draw(rng, read_machine(FILES[label]), hard)


def usual(name: str, chain) -> float:
    """Size of an effect that the library expects, in the unit in which amplitudes are stated."""
    from matstd.diagnosis.fit import file_unit
    from matstd.twin.library import parse_effect

    first = parse_effect(name, chain).parameters[0]
    return float(first.sd / file_unit(first.unit)[1])


def simulated(number: int, times: float):
    """A run that hides a large effect, and the truth about it."""
    from simulator_case import read_back, simulate_case

    rng = np.random.default_rng([SEED, number])
    label, hard = MACHINES[number % 3], bool(number % 2)
    chain = read_back(*simulate_case(rng, label)[:2]).touches.chain
    effect = drawn(rng, label, hard)
    effect.amplitude = times * usual(effect.name, chain)
    run, machine, truth = simulate_case(rng, label, [effect], hard)
    return read_back(run, machine), truth["hidden"][0]


def one(job: tuple[int, float]):
    """What was hidden, what was found, whether that is right, true size, found size, seconds."""
    from matstd.diagnosis.answer import Verdict, diagnose

    run, hidden = simulated(*job)
    start = time.process_time()
    result = diagnose(run)
    seconds = time.process_time() - start
    steps = named_steps(result)
    right = result.verdict is Verdict.MISSING and len(steps) == 1
    if right:
        names = names_of(steps[0])
        right = steps[0].effect.name in alike_names(hidden) or hidden["effect"] in names
    own = next((s for s in steps if s.effect.name == hidden["effect"]), None)
    size = next((r for r in own.reported if r.quantity == "amplitude"), None) if own else None
    found = listed(steps) or "-"
    sized = None if size is None else (size.value, size.u)
    return job[0], hidden, found, result.verdict.value, right, sized, seconds


def main() -> None:
    parser = run_options(__doc__, runs=20)
    parser.add_argument("--times", type=float, default=10.0, help="size over the usual one")
    args = parser.parse_args()
    jobs = [(args.first + k, args.times) for k in range(args.runs)]
    results = in_processes(one, jobs, args.jobs)
    for number, hidden, found, verdict, right, sized, seconds in results:
        size = "" if sized is None else f", size {abs(sized[0]):.5g} ± {sized[1]:.2g}"
        print(
            f"{mark(right)} {number:3} {hidden['effect']} "
            f"{hidden['amplitude']:.4g} ({hidden['signal_to_noise']:.0f} times the noise) -> "
            f"{found} [{verdict}]{size}  {seconds:.1f} s"
        )
    print(f"right {sum(r[4] for r in results)} of {len(results)}")


if __name__ == "__main__":
    main()
