"""Error of every probe on the held-out part, step by step, beside what simple fits reach there.

python examples/fl_thermal/before_after.py
"""

from pathlib import Path

import numpy as np
from make_run import PROBES, spindle_run

from matstd.diagnosis.answer import Diagnosis, diagnose
from matstd.twin.library import load_user_effects
from matstd.twin.units import UM

HERE = Path(__file__).resolve().parent

SIMPLE_FITS = {
    "constant": (5.42, 5.86, 17.58, 17.16, 8.21),
    "speed, one time constant": (4.33, 5.28, 18.07, 17.75, 9.70),
    "speed, two time constants": (3.62, 4.62, 19.91, 20.41, 7.00),
    "... and one temperature": (2.16, 2.41, 7.46, 7.03, 6.51),
    "... and four temperatures": (2.04, 2.10, 5.68, 3.07, 4.56),
    "all 16 temperatures, least squares": (4.62, 3.51, 6.21, 5.62, 6.26),
    "all 16 temperatures, ridge": (3.68, 3.38, 3.08, 3.22, 3.77),
}
"""Held-out RMS of fits made for each probe alone on the one-minute record, µm."""


def held_out(result: Diagnosis) -> dict[str, tuple[float, ...]]:
    """RMS error of every probe on the held-out rows, µm, by step; every row counts, as it is."""
    touches, out = result.run.touches, {}
    for step in result.steps:
        name = "starting model" if step.effect is None else f"+ {step.effect.name}"
        rows = [(result.run.split == "test") & (touches.feature == probe) for probe in PROBES]
        out[name] = tuple(float(np.sqrt(np.mean(step.fit.residual[r] ** 2))) / UM for r in rows)
    return out


def line(name: str, errors: tuple[float, ...]) -> str:
    together = np.sqrt(np.mean(np.square(errors)))
    return f"{name:36}" + "".join(f"{e:7.2f}" for e in (*errors, together))


if __name__ == "__main__":
    load_user_effects(HERE / "warm_body.py")
    print(f"{'held-out RMS, µm':36}" + "".join(f"{name:>7}" for name in (*PROBES, "all")))
    for name, errors in SIMPLE_FITS.items():
        print(line(name, errors))
    print("this diagnosis")
    for name, errors in held_out(diagnose(spindle_run())).items():
        print(line(name, errors))
