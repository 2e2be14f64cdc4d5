"""Share of every error in the volumetric deviation, exact to first order."""

from collections.abc import Iterator
from itertools import combinations, groupby

import numpy as np

from matstd.sensitivity.first_order.jacobians import jacobian, jacobian_blocks
from matstd.sensitivity.population import CONSTANT, Mix, Population, product_moment
from matstd.twin.frames import Array
from matstd.twin.machine import Symbol, checked_readings, shape, sine_argument

_PAIRS = ((0, 0), (1, 1), (2, 2), (0, 1), (1, 2), (0, 2))  # entries of a symmetric matrix


def mean_squares(population: Population, q: Array) -> Array:
    """Expected square of every error at the readings of every pose, (N, P), in closed form.

    ``E[e^2] = E[a^2] mean(f^2)`` over the shapes that may be drawn, each with its chance and with
    ``f^2 = 1/2`` for a sine of random phase. The errors have mean zero, because their signs are
    drawn evenly.
    """
    chain = population.chain
    q = checked_readings(chain, q)
    out = np.empty((len(q), len(chain.symbols)))
    known: dict[tuple[str, Mix], Array] = {}
    for p, symbol in enumerate(chain.symbols):
        axis, mix = _over(population, symbol)
        mean: Array | float = 1.0
        if axis:
            if (axis, mix) not in known:
                known[axis, mix] = _mean_square(population, q, axis, mix)
            mean = known[axis, mix]
        out[:, p] = population.ranges.sd(chain, symbol) ** 2 * mean
    return out


def _mean_square(population: Population, q: Array, axis: str, mix: Mix) -> Array:
    """Mean over the shapes of the squared shape function of one axis, (N,)."""
    chain = population.chain
    reading, link = q[:, chain.axis_index(axis)], chain.link(axis)
    squares = [
        np.full(len(q), 0.5) if name == "sinusoidal" else shape(name, reading, link) ** 2
        for name in mix.shapes
    ]
    return np.average(squares, axis=0, weights=mix.chances)


def mixed_moments(population: Population, q: Array) -> Iterator[tuple[int, int, Array]]:
    """Places of every two errors that depend on each other, and their expected products, (N,).

    ``E[a b] mean(f g)``. Shapes that are drawn apart have ``mean(f) mean(g)``, in which a sine of
    random phase has mean zero; shapes drawn together ``mean(f g)``, with ``cos(x - y)/2`` for two
    sines of the same phase at the arguments x and y.
    """
    dependence, factor, some = population.dependence, population.score_factor, population.dependent
    if dependence is None or factor is None:
        return
    moment = product_moment(np.clip(factor @ factor.T, -1.0, 1.0), *population.limits[:, some])
    symbols = [population.chain.symbols[p] for p in some]
    for (i, one), (j, two) in combinations(enumerate(symbols), 2):
        if dependence.correlation[i, j] == 0.0:
            continue
        alike = any(one.name in group and two.name in group for group in dependence.alike)
        mean = (
            _mean_product(population, q, one, two)
            if alike
            else _mean(population, q, one) * _mean(population, q, two)
        )
        yield some[i], some[j], moment[i, j] * mean


def _mean(population: Population, q: Array, symbol: Symbol) -> Array:
    """Mean over the shapes of the shape function of one error, (N,)."""
    axis, mix = _over(population, symbol)
    if not axis:
        return np.ones(len(q))
    reading, link = q[:, population.chain.axis_index(axis)], population.chain.link(axis)
    return sum(
        chance * shape(name, reading, link)
        for name, chance in zip(mix.shapes, mix.chances, strict=True)
        if name != "sinusoidal"
    ) + np.zeros(len(q))


def _mean_product(population: Population, q: Array, one: Symbol, two: Symbol) -> Array:
    """Mean over the shapes of the product of two shape functions that are drawn together, (N,)."""
    chain, mix = population.chain, population.mix_of(one)
    if mix == CONSTANT:
        return np.ones(len(q))
    (x, link_x), (y, link_y) = (
        (q[:, chain.axis_index(s.link)], chain.link(s.link)) for s in (one, two)
    )
    out = np.zeros(len(q))
    for name, chance in zip(mix.shapes, mix.chances, strict=True):
        if name != "sinusoidal":
            out += chance * shape(name, x, link_x) * shape(name, y, link_y)
            continue
        for n in mix.periods:
            apart = sine_argument(x, link_x, float(n)) - sine_argument(y, link_y, float(n))
            out += chance / len(mix.periods) * 0.5 * np.cos(apart)
    return out


def variance_parts(population: Population, q: Array, length: Array | float) -> Array:
    """Part of every error in the mean square of the deviation, (N, P), mm^2, first order.

    ``E|d|^2 = sum_p |dp/dE_p|^2 E[e_p^2]`` for independent errors of mean zero. Of the mixed term
    of two errors that depend on each other each gets a half, so a part may be negative, where an
    error compensates another one.

    Reference:
        Li et al., Anal. Chem. 82 (2010) 2417: shares of covariance for correlated inputs.
    """
    J = jacobian(population.chain, q, length)
    out = np.einsum("npi,npi->np", J, J) * mean_squares(population, q)
    for p, r, moment in mixed_moments(population, q):
        mixed = np.einsum("ni,ni->n", J[:, p], J[:, r]) * moment
        out[:, p] += mixed
        out[:, r] += mixed
    return out


def variance_shares(population: Population, q: Array, length: Array | float) -> Array:
    """Share of every error in the variance of the deviation vector, (N, P); rows sum to one.

    These are Sobol's indices of the vector deviation (first-order and total are the same, as it is
    linear in independent errors), by the trace of its covariance. For the norm |d| itself they
    hold approximately; `matstd.sensitivity.shares.total_effect_indices` has them by simulation.

    Reference:
        Gamboa et al., Electron. J. Statist. 8 (2014) 575: Sobol indices of vector outputs.
    """
    each = variance_parts(population, q, length)
    total = each.sum(axis=1, keepdims=True)
    return each / np.where(total > 0.0, total, 1.0)


def rms(population: Population, q: Array, length: Array | float) -> Array:
    """Root mean square of the volumetric error |d| at every pose, (N,), mm, without sampling."""
    return np.sqrt(np.maximum(variance_parts(population, q, length).sum(axis=1), 0.0))


def covariance(population: Population, q: Array, length: Array | float) -> Array:
    """Covariance of the deviation vector at every pose, (N, 3, 3), mm^2, first order.

    ``C = sum_p E[e_p^2] J_p J_p^T``. The mean square of an error is a constant of the parameter
    times a function of the reading of its axis, so the sums run over the parameters of each axis.
    Errors that depend on each other add ``E[e_p e_r] (J_p J_r^T + J_r J_p^T)``.
    """
    chain = population.chain
    q = checked_readings(chain, q)
    # errors with one mean square follow each other, so a slice of the columns is one sum
    order = sorted(chain.symbols, key=lambda s: (s.link, str(population.mix_of(s))))
    weight = np.array([population.ranges.sd(chain, s) ** 2 for s in order])
    over = [_over(population, symbol) for symbol in order]
    lots = [list(lot) for _, lot in groupby(range(len(order)), key=over.__getitem__)]
    place = [order.index(symbol) for symbol in chain.symbols]
    out = np.empty((6, len(q)))
    for rows, J in jacobian_blocks(chain, q, length, order):
        total = np.zeros((6, J.shape[-1]))
        for lot in lots:
            columns = J[lot[0] : lot[-1] + 1]
            scaled = columns * weight[lot[0] : lot[-1] + 1, None, None]
            sums = np.stack([np.einsum("pn,pn->n", columns[:, i], scaled[:, j]) for i, j in _PAIRS])
            axis, mix = over[lot[0]]
            total += sums * _mean_square(population, q[rows], axis, mix) if axis else sums
        for p, r, moment in mixed_moments(population, q[rows]):
            one, two = J[place[p]], J[place[r]]
            for k, (i, j) in enumerate(_PAIRS):
                total[k] += moment * (one[i] * two[j] + two[i] * one[j])
        out[:, rows] = total
    C = np.empty((len(q), 3, 3))
    for k, (i, j) in enumerate(_PAIRS):
        C[:, i, j] = C[:, j, i] = out[k]
    return C


def _over(population: Population, symbol: Symbol) -> tuple[str, Mix]:
    """Axis over whose reading an error varies, and how; no axis for a constant."""
    mix = population.mix_of(symbol)
    return ("" if mix == CONSTANT else symbol.link), mix
