"""Several runs of one machine, exactly simulated: what it is stays, or changes as it is told to."""

from collections.abc import Callable, Mapping, Sequence

import numpy as np
from simulator import probe, run_text
from simulator_case import read_back
from simulator_experiment import MACHINES, STATED_NOISE, constant, random_experiment


def simulated_runs(
    rng: np.random.Generator,
    label: str,
    changes: Sequence[Mapping[str, float]],
    hidden: Sequence = (),
    poses: int = 10,
) -> list[str]:
    """Texts of run files of one machine, each with a standard and set-ups of its own.

    Args:
        rng: Source of all that is random.
        label: Which machine.
        changes: For every run, by how much errors differ from those of the machine, mm or rad.
        hidden: Effects with their amplitudes, in every run.
        poses: Table poses of every set-up.
    """
    errors, out = None, []
    for changed in changes:
        e = random_experiment(rng, label, poses)
        errors = e.errors if errors is None else errors
        e.errors = dict(errors)
        for name, size in changed.items():
            e.errors[name] = _sum(errors.get(name, constant(0.0)), constant(size))
        noise = rng.normal(0.0, STATED_NOISE, len(e.time))
        out.append(run_text(e, probe(e, list(hidden), noise), with_speed=False))
    return out


def _sum(one: Callable, other: Callable) -> Callable:
    return lambda q: one(q) + other(q)


def read_runs(texts: Sequence[str], label: str) -> list:
    return [read_back(text, MACHINES[label]) for text in texts]
