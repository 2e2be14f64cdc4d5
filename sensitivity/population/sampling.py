"""Random machines: every error drawn from the distributions of the D-MT paper."""

from collections.abc import Iterator
from dataclasses import dataclass, field
from functools import cached_property

import numpy as np

from matstd.sensitivity.population.dependence import Dependence, amplitude, score_factor
from matstd.sensitivity.population.distributions import CONSTANT, Distributions, Mix
from matstd.twin.effects import ComponentError, LocationError
from matstd.twin.errors import DesignError
from matstd.twin.frames import Array, IntArray
from matstd.twin.machine import Chain, Family, Ranges, Symbol
from matstd.twin.machine import shape as shape_function
from matstd.twin.model import Effect, Model, traits

DRAWS_A_CHILD = 512
"""Machines drawn from one child of a generator: fixed, so that blocks do not change the draws."""
_QUARTER = 0.5 * np.pi


@dataclass(frozen=True, eq=False)
class Population:
    """All machines that may be drawn.

    Raises:
        UnknownSymbol: A name that the machine does not have.
        DesignError: Shapes of a constant, correlations that the ranges do not allow, or errors with
            shapes in common that have different ones to draw from.
    """

    chain: Chain
    # smallest and largest peak amplitude of every error
    ranges: Ranges = field(default_factory=Ranges)
    distributions: Distributions = field(default_factory=Distributions)  # shapes over the readings
    # which errors depend on each other; None for independent ones
    dependence: Dependence | None = None

    def __post_init__(self) -> None:
        self.distributions.check(self.chain)
        if self.dependence is None:
            return
        for name in self.dependence.names:
            self.chain.symbol(name)
        for group in self.dependence.alike:
            mixes = {self.mix_of(self.chain.symbol(name)) for name in group}
            if len(mixes) > 1:
                raise DesignError(
                    f"group of {', '.join(group)}: expected the same shapes to draw from, found "
                    + " and ".join(", ".join(mix.shapes) for mix in sorted(mixes, key=str))
                )
        assert self.score_factor is not None

    @cached_property
    def score_factor(self) -> Array | None:
        """Factor of the normal scores of dependent amplitudes, (n, n); None if there are none."""
        if self.dependence is None:
            return None
        return score_factor(self.dependence, *self.limits[:, self.dependent])

    @cached_property
    def dependent(self) -> list[int]:
        """Places of the dependent errors among the symbols of the chain."""
        names = [symbol.name for symbol in self.chain.symbols]
        return [names.index(name) for name in self.dependence.names] if self.dependence else []

    @cached_property
    def limits(self) -> Array:
        """Smallest and largest amplitude of every error, (2, P)."""
        return np.array([self.ranges.of(self.chain, s) for s in self.chain.symbols]).T

    @cached_property
    def _mixes(self) -> dict[Symbol, Mix]:
        return {s: self.distributions.of(self.chain, s) for s in self.chain.symbols}

    def mix_of(self, symbol: Symbol) -> Mix:
        """Shapes that an error may have."""
        return self._mixes[symbol]

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
            mix = self.mix_of(symbol)
            for shape in mix.shapes:
                if shape != "sinusoidal":
                    effects.append(ComponentError(symbol, shape, sd=sd))
                    continue
                # sine and cosine together are a sine of any phase
                effects += [
                    ComponentError(symbol, shape, periods=float(n), phase=phase, sd=sd)
                    for n in mix.periods
                    for phase in (0.0, _QUARTER)
                ]
        return Model(self.chain, tuple(effects))

    def expected(self, free: str = "") -> Model:
        """The same without errors stated to be zero, but for the set-up of links in `free`."""

        def is_kept(effect: Effect) -> bool:
            symbol = traits(effect).symbol
            is_free = symbol is not None and symbol.family is Family.SETUP and symbol.link in free
            return is_free or effect.parameters[0].sd > 0.0

        return Model(self.chain, tuple(filter(is_kept, self.model.effects)))


@dataclass(frozen=True, eq=False)
class Draws:
    """S drawn machines; every array is (S, P) over the symbols of the chain."""

    amplitude: Array  # peak amplitude with its sign, mm or rad
    shape: IntArray  # index into the shapes that the error may have
    periods: IntArray  # of a sinusoidal error
    phase: Array  # of a sinusoidal error, rad

    def __len__(self) -> int:
        return len(self.amplitude)


def draw(population: Population, count: int, rng: np.random.Generator) -> Draws:
    """Machines with random errors: amplitude even over its range, random sign, shape and phase.

    Errors are independent of each other where `Population.dependence` does not say otherwise.
    """
    symbols = population.chain.symbols
    mixes = [population.mix_of(s) for s in symbols]
    low, high = population.limits
    size = (count, len(symbols))
    sign = rng.choice([-1.0, 1.0], size=size)
    draws = Draws(
        amplitude=sign * rng.uniform(low, high, size=size),
        shape=rng.integers([len(mix.shapes) for mix in mixes], size=size),
        periods=rng.integers([len(mix.periods) for mix in mixes], size=size),
        phase=rng.uniform(0.0, 2.0 * np.pi, size=size),
    )
    for p, mix in enumerate(mixes):
        draws.periods[:, p] = np.array(mix.periods)[draws.periods[:, p]]
        if mix.weights:
            draws.shape[:, p] = rng.choice(len(mix.shapes), count, p=mix.chances)
    _depend(population, draws, rng)
    return draws


def _depend(population: Population, draws: Draws, rng: np.random.Generator) -> None:
    """Replace amplitudes and shapes of dependent errors."""
    factor, dependence = population.score_factor, population.dependence
    if factor is None or dependence is None:
        return
    some = population.dependent
    z = rng.standard_normal((len(draws), len(some))) @ factor.T
    draws.amplitude[:, some] = amplitude(z, *population.limits[:, some])
    place = dict(zip(dependence.names, some, strict=True))
    for first, *others in dependence.alike:
        for name in others:
            for each in (draws.shape, draws.periods, draws.phase):
                each[:, place[name]] = each[:, place[first]]


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
        mix = population.mix_of(symbol)
        for i, shape in enumerate(mix.shapes):
            has = np.where(draws.shape[:, p] == i, a, 0.0)
            if shape != "sinusoidal":
                columns.append(has)
                continue
            for n in mix.periods:
                wave = np.where(draws.periods[:, p] == n, has, 0.0)
                columns += [wave * np.cos(phase), wave * np.sin(phase)]
    return np.stack(columns, axis=1)


def shape_columns(population: Population, q: Array) -> list[Array]:
    """Shape functions of each error at every pose, (N, K_p) each.

    The value of error p at a pose is its row here times its part of `coefficients`.
    """
    chain, out = population.chain, []
    for symbol in chain.symbols:
        mix, link = population.mix_of(symbol), chain.link(symbol.link)
        if mix == CONSTANT:
            out.append(np.ones((len(q), 1)))
            continue
        reading, columns = q[:, chain.axis_index(symbol.link)], []
        for name in mix.shapes:
            if name != "sinusoidal":
                columns.append(shape_function(name, reading, link))
                continue
            for n in mix.periods:
                for phase in (0.0, _QUARTER):
                    columns.append(shape_function(name, reading, link, float(n), phase))
        out.append(np.stack(columns, axis=1))
    return out


def drawn_errors(population: Population, rng: np.random.Generator) -> list[tuple[Effect, Array]]:
    """One random machine as effects with their amplitudes, as an error file holds it."""
    draws = draw(population, 1, rng)
    out: list[tuple[Effect, Array]] = []
    for p, symbol in enumerate(population.chain.symbols):
        amplitude = draws.amplitude[0, p : p + 1]
        if symbol.family is not Family.COMPONENT:
            out.append((LocationError(symbol), amplitude))
            continue
        shape = population.mix_of(symbol).shapes[draws.shape[0, p]]
        if shape == "sinusoidal":
            n, phase = float(draws.periods[0, p]), float(draws.phase[0, p])
            out.append((ComponentError(symbol, shape, n, phase), amplitude))
        else:
            out.append((ComponentError(symbol, shape), amplitude))
    return out


SMALLEST_SCALE = 1e-3
"""Smallest size of a drawn error, as a share of the expected one: no error is known to be zero."""


def drawn_scales(
    population: Population, count: int, rng: np.random.Generator, model: Model | None = None
) -> Array:
    """Size of every parameter, of `Population.model` or another, of drawn machines, (S, P).

    Over its expected size. All distributions of one error of one machine share its drawn amplitude,
    so a machine whose EXX is large has it large as prior, whichever shape it will turn out to have.
    The mean of the squares over many machines is one.
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
    return np.maximum(size, SMALLEST_SCALE)[:, column]
