"""Which error makes how much of the volumetric deviation: exact for independent errors."""

from itertools import groupby

import numpy as np

from sensitivity.by_parameter import jacobian_blocks
from sensitivity.jacobian import jacobian
from sensitivity.sampling import Population
from twin.frames import Array
from twin.kinematics import checked_readings
from twin.shapes import ShapeName, shape
from twin.symbols import Family, Symbol

_PAIRS = ((0, 0), (1, 1), (2, 2), (0, 1), (1, 2), (0, 2))  # entries of a symmetric matrix


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
    """Covariance of the deviation vector at every pose, (N, 3, 3), mm^2, first order.

    ``C = sum_p E[e_p^2] J_p J_p^T``. The mean square of an error is a constant of the parameter
    times a function of the reading of its axis, so the sums run over the parameters of each axis.
    """
    chain = population.chain
    q = checked_readings(chain, q)
    order = sorted(chain.symbols, key=lambda s: (s.link, s.family is not Family.COMPONENT))
    weight = np.array([population.ranges.sd(chain, s) ** 2 for s in order])
    over = [_over(population, symbol) for symbol in order]
    lots = [list(lot) for _, lot in groupby(range(len(order)), key=over.__getitem__)]
    out = np.empty((6, len(q)))
    for rows, J in jacobian_blocks(chain, q, length, order):
        total = np.zeros((6, J.shape[-1]))
        for lot in lots:
            columns = J[lot[0] : lot[-1] + 1]
            scaled = columns * weight[lot[0] : lot[-1] + 1, None, None]
            sums = np.stack([np.einsum("pn,pn->n", columns[:, i], scaled[:, j]) for i, j in _PAIRS])
            axis, shapes = over[lot[0]]
            total += sums * _mean_square(population, q[rows], axis, shapes) if axis else sums
        out[:, rows] = total
    C = np.empty((len(q), 3, 3))
    for k, (i, j) in enumerate(_PAIRS):
        C[:, i, j] = C[:, j, i] = out[k]
    return C


def _over(population: Population, symbol: Symbol) -> tuple[str, tuple[ShapeName, ...]]:
    """Axis and shapes over whose reading an error varies; no axis for a constant."""
    shapes = population.shapes_of(symbol)
    return ("", shapes) if shapes == ("constant",) else (symbol.link, shapes)
