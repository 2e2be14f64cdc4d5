"""Several runs of one machine, exactly simulated: it stays as it is, or changes as stated."""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import replace

import numpy as np
from simulator import probe, run_text
from simulator_case import read_back
from simulator_experiment import MACHINES, STATED_NOISE, constant, placed, random_experiment


def simulated_runs(
    rng: np.random.Generator,
    label: str,
    changes: Sequence[Mapping[str, float]],
    hidden: Sequence = (),
    poses: int = 10,
    same_standard: bool = False,
) -> list[str]:
    """Texts of run files of one machine.

    Args:
        rng: Source of all that is random.
        label: Which machine.
        changes: For every run, by how much errors differ from those of the machine, mm or rad.
        hidden: Effects with their amplitudes, in every run.
        poses: Table poses of every set-up.
        same_standard: Whether one standard is put where it was and probed by the same program;
            otherwise every run has a standard, set-ups and a program of its own.
    """
    e = random_experiment(rng, label, poses)
    errors, out = e.errors, []
    for i, changed in enumerate(changes):
        if i and same_standard:
            e = replace(e, actual=placed(rng, e.stated))
        elif i:
            e = random_experiment(rng, label, poses)
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
