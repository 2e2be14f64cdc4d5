"""Coverage of scales probed on a standard that is not at 20 degC: known, unknown, unstated.

    python benchmarks/standard_temperature.py [-n 100] [--first 0] [--machine hsm600u]

Runs come from the exact simulator of `tests/oracles`, which lets the standard grow by its own
formula, true scales from its own product of matrices. The true expansion is drawn about the stated
one, and the thermometer errs by its uncertainty:

    known     15 to 30 degC; the run states what the thermometer reads
    scaled    the same, calibrated by a CMM with a scale of 0 +- 5 ppm, which the run states
    unknown   20 +- 2 degC; the run states the expansion alone
    unstated  15 to 30 degC; the run states nothing
"""

import numpy as np
from harness import MACHINES, parser_of

ALPHA, U_ALPHA = 10.5e-6, 1.05e-6
U_KNOWN, U_UNKNOWN = 0.3, 2.0
U_SCALE = 5e-6
CASES = ("known", "scaled", "unknown", "unstated")
POSES = 5  # table poses of each of three set-ups


def head(case: str, reading: float) -> str:
    """What the head of the run states."""
    if case == "unstated":
        return ""
    known = ""
    if case in ("known", "scaled"):
        known = f", body_degC = {reading:.3f}, body_u_K = {U_KNOWN}"
    if case == "scaled":
        known += f", scale_u_ppm = {1e6 * U_SCALE:g}"
    return f"# standard = {{ expansion_1_K = {ALPHA}, expansion_u_1_K = {U_ALPHA}{known} }}"


def scales(seed: int, machine: str, case: str) -> dict[str, tuple[float, float, float]]:
    """Of every scale its estimate, its standard uncertainty and the truth."""
    from simulator_experiment import random_experiment
    from simulator_warmth import probed_warm, true_scales

    from matstd.diagnosis.fit import fit_run
    from matstd.diagnosis.geometry import Quantity, geometry_rows
    from matstd.twin.library import ordinary_model

    rng = np.random.default_rng(seed)
    e = random_experiment(rng, machine, POSES)
    t = rng.normal(20.0, U_UNKNOWN) if case == "unknown" else rng.uniform(15.0, 30.0)
    alpha, reading = rng.normal(ALPHA, U_ALPHA), rng.normal(t, U_KNOWN)
    text = head(case, reading)
    if case == "scaled":  # one more relative growth, expressed by the expansion
        alpha += rng.normal(0.0, U_SCALE) / (t - 20.0)
    run = probed_warm(e, rng, alpha, t, text)
    fit = fit_run(run, ordinary_model(run.touches.chain))
    truth = true_scales(e, run.touches[fit.used])
    return {
        row.symbol: (row.estimate.value, row.estimate.u, truth[row.symbol])
        for row in geometry_rows(fit)
        if row.quantity is Quantity.SCALE
    }


def main() -> None:
    """Print how often the truth lies within two standard uncertainties."""
    parser = parser_of(__doc__)
    parser.add_argument("-n", type=int, default=100, help="runs of each case (100)")
    parser.add_argument("--first", type=int, default=0, help="seed of the first run (0)")
    parser.add_argument("--cases", nargs="+", choices=CASES, default=CASES)
    parser.add_argument("--machine", choices=MACHINES, default="hsm600u")
    args = parser.parse_args()
    for case in args.cases:
        seeds = range(args.first, args.first + args.n)
        found = [scales(seed, args.machine, case) for seed in seeds]
        for name in ("EXX", "EYY", "EZZ"):
            v, u, truth = np.array([one[name] for one in found]).T
            within, z = int(np.sum(np.abs(v - truth) <= 2.0 * u)), (v - truth) / u
            print(
                f"{case:8s} {name}: {within} of {args.n} within 2 u, u {1e6 * u.mean():.1f} ppm, "
                f"error {1e6 * np.sqrt(np.mean((v - truth) ** 2)):.1f} ppm rms, "
                f"{np.sqrt(np.mean(z**2)):.2f} u rms",
                flush=True,
            )


if __name__ == "__main__":
    main()
