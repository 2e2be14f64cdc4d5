"""Which error makes how much of the volumetric deviation: exact for independent errors."""

import numpy as np

from sensitivity.jacobian import jacobian
from sensitivity.sampling import Population
from twin.frames import Array
from twin.kinematics import checked_readings
from twin.shapes import ShapeName, shape


def mean_squares(population: Population, q: Array) -> Array:
    """Expected square of every error at the readings of every pose, in closed form.

    ``E[e^2] = E[a^2] mean(f^2)`` over the shapes that may be drawn, with ``f^2 = 1/2`` for a sine
    of random phase. The errors have mean zero, because their signs are drawn evenly.

    Args:
        population: The machines that may be drawn.
        q: Readings, shape (N, A).

    Returns:
        Shape (N, P) over the symbols of the chain, mm^2 and rad^2.
    """
    chain = population.chain
    q = checked_readings(chain, q)
    out = np.empty((len(q), len(chain.symbols)))
    by_axis: dict[str, Array] = {}
    for p, symbol in enumerate(chain.symbols):
        shapes = population.shapes_of(symbol)
        mean: Array | float = 1.0
        if shapes != ("constant",):
            if symbol.link not in by_axis:
                by_axis[symbol.link] = _mean_square(population, q, symbol.link, shapes)
            mean = by_axis[symbol.link]
        out[:, p] = population.ranges.sd(chain, symbol) ** 2 * mean
    return out


def _mean_square(
    population: Population, q: Array, axis: str, shapes: tuple[ShapeName, ...]
) -> Array:
    """Mean over the shapes of the squared shape function of one axis, (N,)."""
    chain = population.chain
    reading, link = q[:, chain.axis_index(axis)], chain.link(axis)
    squares = [
        np.full(len(q), 0.5) if name == "sinusoidal" else shape(name, reading, link) ** 2
        for name in shapes
    ]
    return np.mean(squares, axis=0)


def parts(population: Population, q: Array, length: Array | float) -> Array:
    """Part of every error in the mean square of the deviation, (N, P), mm^2, first order.

    ``E|d|^2 = sum_p |dp/dE_p|^2 E[e_p^2]``: the errors are independent with mean zero, so no mixed
    terms are left and the parts are exact for the first-order deviation.
    """
    J = jacobian(population.chain, q, length)
    return np.einsum("npi,npi->np", J, J) * mean_squares(population, q)


def variance_shares(population: Population, q: Array, length: Array | float) -> Array:
    """Share of every error in the variance of the deviation vector, (N, P); rows sum to one.

    These are Sobol's indices of the vector deviation (first-order and total are the same, as it is
    linear in independent errors), by the trace of its covariance. For the norm |d| itself they
    hold approximately.

    Reference:
        Gamboa et al., Electron. J. Statist. 8 (2014) 575: Sobol indices of vector outputs.
    """
    each = parts(population, q, length)
    total = each.sum(axis=1, keepdims=True)
    return each / np.where(total > 0.0, total, 1.0)


def rms(population: Population, q: Array, length: Array | float) -> Array:
    """Root mean square of the volumetric error |d| at every pose, (N,), mm, without sampling."""
    return np.sqrt(parts(population, q, length).sum(axis=1))


def covariance(population: Population, q: Array, length: Array | float) -> Array:
    """Covariance of the deviation vector at every pose, (N, 3, 3), mm^2, first order."""
    J = jacobian(population.chain, q, length)
    return np.einsum("npi,np,npj->nij", J, mean_squares(population, q), J)
