"""Is the stated held-out error the plain error of a second, independent run of the same machine?

    python benchmarks/promised_error.py [--runs 60] [--first 0] [--jobs 1]

Both runs come from the independent exact simulator and share the machine with its errors and its
hidden effects (none, one or two). The second run has the same programme, but the standard stands
elsewhere by chance, the temperatures are others, and so is the noise. A third has other poses and
other touches in the same set-ups: how far it can be predicted depends on how far it leaves what was
probed, so it is held against what the comparison expects at its own touches.
"""

from dataclasses import replace
from unittest.mock import patch

import numpy as np
from harness import MACHINES, in_processes, run_options

SEED = 61
WITHIN = 0.1
OF_ONE_RUN = ("artefact", "drift")  # effects that belong to a run, not to the machine


def drawn(rng, machine):
    """A random effect of the machine itself."""
    from simulator_draw import draw

    while True:
        effect = draw(rng, machine, False)
        if not effect.name.startswith(OF_ONE_RUN):
            return effect


def three_runs(number: int):
    """A run, the same programme again, other poses in the same set-ups; names of what is hidden."""
    import simulator_experiment as se
    from simulator import probe, run_text
    from simulator_case import Ordinary, place_one, read_back

    rng = np.random.default_rng([SEED, number])
    label = MACHINES[number % 3]
    first = se.random_experiment(rng, label)
    again = replace(
        first,
        actual=se.placed(rng, first.stated),
        temperature={k: np.round(v, 3) for k, v in se.temperatures(rng, first.time).items()},
    )
    with patch.object(se, "random_setups", lambda r, _: (first.stated, se.placed(r, first.stated))):
        other = replace(se.random_experiment(rng, label), errors=first.errors)

    def read(e, effects, noise):
        return read_back(run_text(e, probe(e, effects, noise), False), se.MACHINES[label])

    ordinary = Ordinary(read(first, [], np.zeros(len(first.time))).touches)
    hidden = []
    while len(hidden) < number % 3:
        names = [h.name for h in hidden]
        sizes = (12.0, 40.0)
        hidden.append(
            place_one(rng, first, drawn, ordinary, se.STATED_NOISE, sizes, False, names)[0]
        )
    runs = [
        read(e, hidden, rng.normal(0.0, se.STATED_NOISE, len(e.time)))
        for e in (first, again, other)
    ]
    return runs, [h.name for h in hidden]


def one(number: int):
    """Names; stated error, error of the same programme, of other poses, expected there; µm."""
    from matstd.diagnosis.answer import compare, diagnose
    from matstd.diagnosis.fit import Prior
    from matstd.twin.units import UM

    (first, again, other), names = three_runs(number)
    fit = diagnose(first).fit
    m = len(fit.model.parameters)
    estimates = Prior.of_estimates(fit.theta[:m], fit.covariance[:m, :m])
    same, elsewhere = (compare(run, fit.model, estimates) for run in (again, other))
    expected = float(np.sqrt(np.mean(elsewhere.u[elsewhere.counted] ** 2)))
    return names, *(v / UM for v in (fit.test_rms, same.rms, elsewhere.rms, expected))


def main() -> None:
    args = run_options(__doc__, runs=60).parse_args()
    results = in_processes(one, range(args.first, args.first + args.runs), args.jobs)
    for k, (names, stated, same, other, expected) in enumerate(results, args.first):
        print(
            f"{k:3} stated {stated:.3f}, same programme {same:.3f} ({same / stated:.2f}); other "
            f"poses {other:.3f}, expected there {expected:.3f}  {', '.join(names) or '-'}"
        )
    stated, same, other, expected = np.array([r[1:] for r in results]).T
    for words, ratio in (
        ("same programme over stated", same / stated),
        ("other poses over stated", other / stated),
        ("other poses over expected there", other / expected),
    ):
        share = np.mean(np.abs(ratio - 1.0) < WITHIN)
        print(f"{words}: {share:.0%} within 10 %, median {np.median(ratio):.3f}")


if __name__ == "__main__":
    main()
