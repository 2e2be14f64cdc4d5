"""Random machines: every error drawn from the distributions of the D-MT paper."""

from collections.abc import Iterator
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from twin.chain import Chain
from twin.effect import Effect
from twin.effects.geometric import ComponentError
from twin.effects.location import LocationError
from twin.errors import DesignError
from twin.frames import Array
from twin.model import Model
from twin.ranges import Ranges
from twin.shapes import SHAPES, ShapeName
from twin.symbols import Family, Symbol

DRAWS_A_CHILD = 512
"""Machines drawn from one child of a generator: fixed, so that blocks do not change the draws."""

_QUARTER = 0.5 * np.pi


@dataclass(frozen=True)
class Distributions:
    """What the errors of random machines look like over the readings of their axes.

    Attributes:
        shapes: Drawn with equal chance for every component error of a linear axis.
        rotary_shapes: The same for a rotary axis, whose errors repeat every turn.
        periods: Numbers of periods of a sinusoidal error, drawn with equal chance; over the range
            of a linear axis, over a turn of a rotary one.
    """

    shapes: tuple[ShapeName, ...] = ("linear", "parabolic", "sinusoidal")
    rotary_shapes: tuple[ShapeName, ...] = ("sinusoidal",)
    periods: tuple[int, ...] = (1,)

    def __post_init__(self) -> None:
        for shapes in (self.shapes, self.rotary_shapes):
            if not shapes or any(s not in SHAPES for s in shapes):
                raise DesignError(
                    f"shapes {list(shapes)}: expected at least one of {', '.join(SHAPES)}"
                )
        if not self.periods or min(self.periods) < 1:
            raise DesignError(f"periods {list(self.periods)}: expected whole numbers from 1 up")


@dataclass(frozen=True, eq=False)
class Population:
    """All machines that may be drawn.

    Attributes:
        chain: The machine.
        ranges: Smallest and largest peak amplitude of every error.
        distributions: Shapes over the readings.
    """

    chain: Chain
    ranges: Ranges = field(default_factory=Ranges)
    distributions: Distributions = field(default_factory=Distributions)

    def shapes_of(self, symbol: Symbol) -> tuple[ShapeName, ...]:
        """Distributions that an error may have.

        Location and set-up errors are constants, and so are the errors of a spindle that stays at
        one angle.
        """
        link = self.chain.link(symbol.link)
        if symbol.family is not Family.COMPONENT or not link.programmed:
            return ("constant",)
        if link.kind == "rotary":
            return self.distributions.rotary_shapes
        return self.distributions.shapes

    @property
    def model(self) -> Model:
        """Effects whose linear combinations are all machines of the population.

        A sine with a free phase is a sine and a cosine; so every drawn machine is one vector of
        parameters of this model, and its first-order deviations are one product of matrices.
        """
        effects: list[Effect] = []
        for symbol in self.chain.symbols:
            sd = self.ranges.sd(self.chain, symbol)
            if symbol.family is not Family.COMPONENT:
                effects.append(LocationError(symbol, sd))
                continue
            for shape in self.shapes_of(symbol):
                if shape != "sinusoidal":
                    effects.append(ComponentError(symbol, shape, sd=sd))
                    continue
                for n in self.distributions.periods:
                    effects.append(ComponentError(symbol, shape, float(n), 0.0, sd))
                    effects.append(ComponentError(symbol, shape, float(n), _QUARTER, sd))
        return Model(self.chain, tuple(effects))


@dataclass(frozen=True, eq=False)
class Draws:
    """S drawn machines; every array is (S, P) over the symbols of the chain.

    Attributes:
        amplitude: Peak amplitude with its sign, mm or rad.
        shape: Index into the shapes that the error may have.
        periods: Of a sinusoidal error.
        phase: Of a sinusoidal error, rad.
    """

    amplitude: Array
    shape: NDArray[np.int64]
    periods: NDArray[np.int64]
    phase: Array

    def __len__(self) -> int:
        return len(self.amplitude)


def draw(population: Population, count: int, rng: np.random.Generator) -> Draws:
    """Machines with independent errors: amplitude even over its range, random sign, shape, phase.

    Args:
        population: What to draw from.
        count: S.
        rng: Source of the random numbers.
    """
    chain = population.chain
    symbols = chain.symbols
    low, high = np.array([population.ranges.of(chain, s) for s in symbols]).T
    size = (count, len(symbols))
    sign = rng.choice([-1.0, 1.0], size=size)
    return Draws(
        amplitude=sign * rng.uniform(low, high, size=size),
        shape=rng.integers([len(population.shapes_of(s)) for s in symbols], size=size),
        periods=rng.choice(np.array(population.distributions.periods), size=size),
        phase=rng.uniform(0.0, 2.0 * np.pi, size=size),
    )


def drawn_in_chunks(
    population: Population, count: int, rng: np.random.Generator
) -> Iterator[Draws]:
    """Any number of machines, `DRAWS_A_CHILD` at a time, each lot from its own child of `rng`."""
    children = rng.spawn(-(-count // DRAWS_A_CHILD))
    for i, child in enumerate(children):
        yield draw(population, min(DRAWS_A_CHILD, count - i * DRAWS_A_CHILD), child)


def coefficients(population: Population, draws: Draws) -> Array:
    """Drawn machines as parameter vectors of `Population.model`, (S, K)."""
    columns = []
    for p, symbol in enumerate(population.chain.symbols):
        a, phase = draws.amplitude[:, p], draws.phase[:, p]
        for i, shape in enumerate(population.shapes_of(symbol)):
            has = np.where(draws.shape[:, p] == i, a, 0.0)
            if shape != "sinusoidal":
                columns.append(has)
                continue
            for n in population.distributions.periods:
                wave = np.where(draws.periods[:, p] == n, has, 0.0)
                columns += [wave * np.cos(phase), wave * np.sin(phase)]
    return np.stack(columns, axis=1)


def drawn_errors(population: Population, rng: np.random.Generator) -> list[tuple[Effect, Array]]:
    """One random machine as effects with their amplitudes, as an error file holds it."""
    draws = draw(population, 1, rng)
    out: list[tuple[Effect, Array]] = []
    for p, symbol in enumerate(population.chain.symbols):
        amplitude = draws.amplitude[0, p : p + 1]
        if symbol.family is not Family.COMPONENT:
            out.append((LocationError(symbol), amplitude))
            continue
        shape = population.shapes_of(symbol)[draws.shape[0, p]]
        if shape == "sinusoidal":
            n, phase = float(draws.periods[0, p]), float(draws.phase[0, p])
            out.append((ComponentError(symbol, shape, n, phase), amplitude))
        else:
            out.append((ComponentError(symbol, shape), amplitude))
    return out
