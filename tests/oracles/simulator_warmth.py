"""A standard that is not at 20 degC, and the true scales of the machine that probes it."""

import numpy as np
from simulator import probe, run_text
from simulator_case import read_back
from simulator_effects import Hidden
from simulator_experiment import LENGTH, MACHINES, STATED_NOISE
from simulator_machine import tip


def warm(alpha, temperature):
    """A standard with an expansion (1/K) at a temperature (degC)."""

    def act(state, amplitude):
        return {"growth": np.full(len(state), alpha * (temperature - 20.0))}

    return Hidden("warm", "artefact-expansion", act)


def probed_warm(e, noise_rng, alpha, temperature, head=""):
    """Run of an experiment on a warm standard, read back; `head` states it as the run does."""
    noise = noise_rng.normal(0.0, STATED_NOISE, len(e.time))
    text = run_text(e, probe(e, [warm(alpha, temperature)], noise), with_speed=False)
    return read_back(
        text.replace("# u_um", f"{head}\n# u_um", 1) if head else text, MACHINES[e.label]
    )


def true_scales(e, touches):
    """Slope of the true displacement along X, Y and Z through the middle of some touches."""
    middle = {}
    for a in e.machine.programmed:
        q = touches.reading(a)
        middle[a] = 0.0 if a in e.machine.rotary else 0.5 * (q.min() + q.max())
    out = {}
    for axis in "XYZ":
        q = {a: np.full(21, middle[a]) for a in e.machine.programmed}
        q[axis] = np.linspace(touches.reading(axis).min(), touches.reading(axis).max(), 21)
        nominal = tip(e.machine, q, LENGTH)
        moved = tip(e.machine, q, LENGTH, {name: f(q) for name, f in e.errors.items()}) - nominal
        along = nominal[-1] - nominal[0]
        out[f"E{axis}{axis}"] = np.polyfit(q[axis], moved @ along / np.linalg.norm(along), 1)[0]
    return out
