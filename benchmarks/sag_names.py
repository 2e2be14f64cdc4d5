"""Whether sag under weight is named as that, and not as harmonics, with one payload and another.

    python benchmarks/sag_names.py [--runs 12] [--first 0] [--arms 3]

Each case is two runs of one machine in the independent exact simulator. A head or cradle sags under
its weight, or a load lies off the centre of its table, by a third of to twenty times the usual; the
second run carries `HEAVIER` times the weight. Right is the sag, or what the same touches cannot
distinguish from it, in both runs. The arms are those of `serial_arm.py`: their second joint sags.
Of a sag that only just shows, products of harmonics may be ahead.
"""

import tempfile
from dataclasses import replace
from pathlib import Path

import numpy as np
import serial_arm
from harness import alike_names, listed, mark, named_steps, names_of, run_options

HEAVIER = 1.6  # weight of the second run over that of the first
TIMES = (0.33, 1.0, 3.0, 10.0, 20.0)  # sizes over the usual ones


def hidden_of(number: int, rng: np.random.Generator):
    """A sag of the machine of a case."""
    import simulator_effects as fx

    if number % 3 == 2:
        return "hsm600u", fx.load_off_centre("EBB", "C", rng.uniform(0.0, 2.0 * np.pi))
    return ("hsm600u", "fork")[number % 2], fx.tilting_weight("B")


def verdict(run, truth: dict) -> tuple[bool, str]:
    """Whether a diagnosis names what is hidden and nothing else, and its names."""
    from matstd.diagnosis.answer import diagnose

    steps = named_steps(diagnose(run))
    wanted = alike_names(truth)
    right = len(steps) == 1 and bool(wanted & names_of(steps[0]))
    return right, listed(steps) or "-"


def one(number: int) -> str:
    """A machine under two payloads."""
    from simulator import probe, run_text
    from simulator_case import Ordinary, place_one, read_back
    from simulator_experiment import MACHINES, STATED_NOISE, random_experiment

    rng = np.random.default_rng([71, number])
    label, effect = hidden_of(number, rng)
    times = TIMES[number % len(TIMES)]
    amplitude = times * (30.0 if "," in effect.name else 100.0)
    first = random_experiment(rng, label)
    out = []
    for e, weight in (
        (first, 1.0),
        (replace(random_experiment(rng, label), errors=first.errors), HEAVIER),
    ):
        still = read_back(run_text(e, probe(e, [], np.zeros(len(e.time))), False), MACHINES[label])
        ordinary = Ordinary(still.touches)
        effect.amplitude = weight * amplitude
        hidden, truth = place_one(rng, e, effect, ordinary, STATED_NOISE, (1, 2), True, [])
        truth["alike"] = [r for r in ordinary.alike(truth["signature"], effect.name) if r[0] > 0.93]
        noise = rng.normal(0.0, STATED_NOISE, len(e.time))
        run = read_back(run_text(e, probe(e, [hidden], noise), False), MACHINES[label])
        right, names = verdict(run, truth)
        out.append(f"{mark(right)} {truth['signal_to_noise']:6.1f} {names}")
    return f"{number:3} {label} {effect.name} {times} times: " + " | ".join(out)


def arm(seed: int) -> str:
    """A serial arm under two payloads."""
    out = []
    for weight in (1.0, HEAVIER):
        rng = np.random.default_rng(seed + 100 * int(weight > 1.0))
        q = rng.uniform(serial_arm.LOW, serial_arm.HIGH, (60, 6))
        p = serial_arm.truth()
        p[42:44] *= weight
        places = serial_arm.seen(q, p) + rng.normal(0.0, serial_arm.NOISE, (60, 3))
        with tempfile.TemporaryDirectory() as folder:
            result = serial_arm.diagnosed(Path(folder), q, places)
        steps = named_steps(result)
        out.append(f"{mark([s.effect.name for s in steps] == ['joint-sag(B2)'])} {listed(steps)}")
    return f"arm {seed}: " + " | ".join(out)


def main() -> None:
    parser = run_options(__doc__, runs=12)
    parser.add_argument("--arms", type=int, default=3)
    args = parser.parse_args()
    for k in range(args.first, args.first + args.runs):
        print(one(k), flush=True)
    for seed in range(args.arms):
        print(arm(seed), flush=True)


if __name__ == "__main__":
    main()
