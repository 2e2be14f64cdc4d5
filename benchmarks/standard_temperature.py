"""Coverage of scales probed on a standard that is not at 20 degC: known, unknown, unstated.

Runs come from the exact simulator of `tests/oracles`, which lets the standard grow by its own
formula; the true scales from its own product of matrices. The true expansion is drawn about the
stated one, the thermometer errs by its uncertainty:

    known     15 to 30 degC; the run states what the thermometer reads
    unknown   20 +- 2 degC; the run states the expansion alone
    unstated  15 to 30 degC; the run states nothing

    python benchmarks/standard_temperature.py -n 100
"""

import argparse
import sys
from pathlib import Path

import numpy as np

sys.path.insert(0, str(Path(__file__).parents[1] / "tests" / "oracles"))

from simulator import probe, run_text
from simulator_case import read_back
from simulator_effects import Hidden
from simulator_experiment import LENGTH, MACHINES, STATED_NOISE, random_experiment
from simulator_machine import tip

from diagnosis.fit import fit_run
from diagnosis.geometry import Quantity, geometry_rows
from twin.library import ordinary_model

ALPHA, U_ALPHA = 10.5e-6, 1.05e-6
U_KNOWN, U_UNKNOWN = 0.3, 2.0
CASES = ("known", "unknown", "unstated")


def warm(alpha, temperature):
    """The standard at a temperature, by the simulator's own formula."""

    def act(state, amplitude):
        return {"growth": np.full(len(state), alpha * (temperature - 20.0))}

    return Hidden("warm", "artefact-expansion", act)


def with_head(text, line):
    """A run file with a further line in its head, and without the sensor of the simulator."""
    return text.replace("# u_um", f"{line}\n# u_um", 1) if line else text


def head_line(case, reading):
    """What the head states of the standard."""
    if case == "unstated":
        return ""
    known = f", body_degC = {reading:.3f}, body_u_K = {U_KNOWN}" if case == "known" else ""
    return f"# standard = {{ expansion_1_K = {ALPHA}, expansion_u_1_K = {U_ALPHA}{known} }}"


def true_scales(e, fit):
    """Slopes of the true displacement along lines through the middle of what was probed."""
    used = fit.run.touches[fit.used]
    middle = {}
    for a in e.machine.programmed:
        q = used.reading(a)
        middle[a] = 0.0 if a in e.machine.rotary else 0.5 * (q.min() + q.max())
    out = {}
    for axis in "XYZ":
        q = {a: np.full(21, middle[a]) for a in e.machine.programmed}
        q[axis] = np.linspace(used.reading(axis).min(), used.reading(axis).max(), 21)
        errors = {name: f(q) for name, f in e.errors.items()}
        moved = tip(e.machine, q, LENGTH, errors) - tip(e.machine, q, LENGTH)
        direction = np.diff(tip(e.machine, q, LENGTH)[[0, -1]], axis=0)[0]
        along = moved @ (direction / np.linalg.norm(direction))
        out[f"E{axis}{axis}"] = np.polyfit(q[axis], along, 1)[0]
    return out


def scales(seed, label, case, temperature=None, poses=10):
    """Of every scale its estimate, its uncertainty and the truth."""
    rng = np.random.default_rng(seed)
    e = random_experiment(rng, label, poses)
    t = rng.normal(20.0, U_UNKNOWN) if case == "unknown" else rng.uniform(15.0, 30.0)
    t = t if temperature is None else temperature
    alpha, reading = rng.normal(ALPHA, U_ALPHA), rng.normal(t, U_KNOWN)
    noise = rng.normal(0.0, STATED_NOISE, len(e.time))
    text = run_text(e, probe(e, [warm(alpha, t)], noise), with_speed=False)
    run = read_back(with_head(text, head_line(case, reading)), MACHINES[label])
    fit = fit_run(run, ordinary_model(run.touches.chain))
    truth = true_scales(e, fit)
    return {
        row.symbol: (row.estimate.value, row.estimate.u, truth[row.symbol])
        for row in geometry_rows(fit)
        if row.quantity is Quantity.SCALE
    }


def main():
    """Print how often the truth lies within two standard uncertainties."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("-n", type=int, default=100, help="runs of each case (100)")
    parser.add_argument("--first", type=int, default=0, help="seed of the first run (0)")
    parser.add_argument("--machine", choices=MACHINES, default="hsm600u")
    args = parser.parse_args()
    seeds = range(args.first, args.first + args.n)
    for case in CASES:
        found = [scales(seed, args.machine, case, poses=5) for seed in seeds]
        for axis in "XYZ":
            v, u, truth = np.array([one[f"E{axis}{axis}"] for one in found]).T
            within = int(np.sum(np.abs(v - truth) <= 2.0 * u))
            print(
                f"{case:8s} E{axis}{axis}: {within} of {args.n} within 2 u, u {1e6 * u.mean():.1f} "
                f"ppm, error {1e6 * np.sqrt(np.mean((v - truth) ** 2)):.1f} ppm rms, "
                f"{np.sqrt(np.mean(((v - truth) / u) ** 2)):.2f} u rms"
            )


if __name__ == "__main__":
    main()
