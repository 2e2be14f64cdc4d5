"""First-order deviations against the exact product, for some machines and poses."""

from dataclasses import dataclass

import numpy as np

from matstd.sensitivity.population import Population, coefficients, draw
from matstd.twin.frames import Array
from matstd.twin.numbers import rms
from matstd.twin.record import at_poses


@dataclass(frozen=True, eq=False)
class ExactCheck:
    """Differences of first order from the exact product, for some machines and poses."""

    machines: int
    poses: int
    rms: float  # root mean square of the difference between the deviation vectors, mm
    worst: float  # largest difference, mm
    rms_deviation: float  # root mean square of the deviations themselves, mm


def exact_check(
    population: Population,
    q: Array,
    length: Array | float,
    machines: int,
    rng: np.random.Generator,
) -> ExactCheck:
    """Compare first-order deviations of a few random machines with the exact product.

    Args:
        q: Readings of the poses to look at, shape (N, A).
        length: Tool length, mm.
    """
    model = population.model
    touches = at_poses(population.chain, q, length)
    G = model.tip_columns(touches)
    off, all_of_it = [], []
    for theta in coefficients(population, draw(population, machines, rng)):
        exact = model.tip_deviation(touches, theta)
        off.append(np.linalg.norm(exact - G @ theta, axis=1))
        all_of_it.append(np.linalg.norm(exact, axis=1))
    difference, size = np.array(off), np.array(all_of_it)
    return ExactCheck(
        machines=machines,
        poses=len(q),
        rms=rms(difference),
        worst=float(difference.max()),
        rms_deviation=rms(size),
    )
