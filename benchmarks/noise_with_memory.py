"""Runs whose noise remembers, AR(1) from touch to touch: false names, verdicts, hidden effects.

    python benchmarks/noise_with_memory.py [--runs 40] [--first 0] [--hidden] [--jobs 1]

The runs come from the independent exact simulator; only its white noise is exchanged for an
autoregression of the same size with a correlation of 0.5 to 0.95 between touches that follow.
"""

import time

import numpy as np
from harness import MACHINES, alike_names, in_processes, mark, named_steps, names_of, run_options

EFFECTS = ("backlash(Y)", "thermal-expansion(Y,scaleY)", "thermal-lag(EZZ)", "periodic(EXX)")


def autoregressive(rng: np.random.Generator, count: int, correlation: float) -> np.ndarray:
    """Unit noise of which every value keeps a share of the one before."""
    out = rng.normal(size=count)
    for i in range(1, count):
        out[i] = correlation * out[i - 1] + np.sqrt(1.0 - correlation**2) * out[i]
    return out


def simulated(seed: int, hidden: bool):
    """A run with such noise, its correlation, and the names of what is hidden."""
    import simulator_case

    rng = np.random.default_rng([20, seed])
    correlation = float(rng.uniform(0.5, 0.95))

    def noise(rng, count, hard):
        size = simulator_case.STATED_NOISE
        return size * autoregressive(rng, count, correlation), size, []

    simulator_case.random_noise = noise
    names = [EFFECTS[seed % len(EFFECTS)]] if hidden else []
    machine = MACHINES[0 if hidden else seed % 3]
    run, machine_file, truth = simulator_case.simulate_case(rng, machine, names, with_alike=hidden)
    alike = [alike_names(h) for h in truth["hidden"]]
    return simulator_case.read_back(run, machine_file), correlation, alike


def one(job: tuple[int, bool]):
    """Seed, correlation, what was found of it, verdict, names, whether right, seconds."""
    from matstd.diagnosis.answer import Verdict, diagnose

    run, correlation, alike = simulated(*job)
    start = time.perf_counter()
    result = diagnose(run)
    seconds = time.perf_counter() - start
    steps = named_steps(result)
    names = [names_of(s) for s in steps if s.confusion]
    right = len(names) == len(alike) and all(any(a & n for n in names) for a in alike)
    right = right and result.verdict is (Verdict.MISSING if alike else Verdict.NONE)
    memory = result.fit.memory
    found = None if memory is None else memory.correlation
    stated = ", ".join(s.effect.name for s in steps) or "-"
    return job[0], correlation, found, result.verdict.value, stated, right, seconds


def main() -> None:
    parser = run_options(__doc__, runs=40)
    parser.add_argument("--hidden", action="store_true", help="with an effect hidden beside it")
    args = parser.parse_args()
    jobs = [(seed, args.hidden) for seed in range(args.first, args.first + args.runs)]
    results = in_processes(one, jobs, args.jobs)
    for seed, true, found, verdict, stated, right, seconds in results:
        shown = "none" if found is None else f"{found:.2f}"
        print(
            f"{mark(right)} {seed:3} correlation {true:.2f} found {shown} "
            f"{verdict:17} {stated}  {seconds:.1f} s"
        )
    named = sum(r[4] != "-" for r in results)
    print(
        f"right {sum(r[5] for r in results)} of {len(results)}; memory found in "
        f"{sum(r[2] is not None for r in results)}; {named} with something named"
    )


if __name__ == "__main__":
    main()
