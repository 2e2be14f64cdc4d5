"""Size of the errors of drawn machines relative to the expected size."""

import numpy as np

from matstd.sensitivity.population.sampling import Population, draw
from matstd.twin.frames import Array
from matstd.twin.machine import Symbol
from matstd.twin.model import Model, traits

SMALLEST_SCALE = 1e-3
"""Smallest size of a drawn error, as a share of the expected one: no error is known to be zero."""


def drawn_scales(
    population: Population, count: int, rng: np.random.Generator, model: Model | None = None
) -> Array:
    """Size of every parameter of drawn machines over its expected size, (S, P).

    All distributions of one error of one machine share its drawn amplitude, so a machine whose EXX
    is large has it large as prior, whichever shape it will turn out to have. The mean of the
    squares over many machines is one.

    Args:
        model: Whose parameters the columns are; None for those of `Population.model`.
    """
    chain = population.chain
    place = {symbol: p for p, symbol in enumerate(chain.symbols)}
    column = []
    for effect, _ in (model or population.model).parameters:
        symbol = traits(effect).symbol
        assert isinstance(symbol, Symbol)  # every effect of a population is an error parameter
        column.append(place[symbol])
    expected = np.array([population.ranges.sd(chain, symbol) for symbol in chain.symbols])
    size = np.abs(draw(population, count, rng).amplitude) / np.where(expected > 0.0, expected, 1.0)
    scale: Array = np.maximum(size, SMALLEST_SCALE)[:, column]
    return scale
