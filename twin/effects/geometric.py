"""Component errors of an axis as functions of its own reading."""

import re
from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import get_args

import numpy as np
from numpy.polynomial.chebyshev import chebvander

from matstd.twin.fields import (
    check_count,
    component_symbol,
    components_of,
    refusal,
    travelling_axes,
)
from matstd.twin.machine import Chain, Ranges, ShapeName, Symbol
from matstd.twin.model import Amounts, Declared, Effect, Kind, Parameter
from matstd.twin.record import Touches
from matstd.twin.units import DEG

HIGHEST = 12  # highest degree accepted; faster variations are `periodic`
PROPOSED_DEGREE = 4
"""Two degrees beyond the ordinary model of a linear axis; what changes faster is `periodic`."""
_DEGREES = re.compile(r"(?:(\d+)-)?(\d+)\Z")
_SHAPE = re.compile(r"([a-z]+)(?:,([\d.]+))?(?:@(-?[\d.]+(?:e-?\d+)?))?\Z")


@dataclass(frozen=True)
class ComponentError(Declared):
    """One component error of an axis in one of the distributions of the D-MT paper.

    ``E(q) = a f(q)`` with f the constant, linear, parabolic or sinusoidal shape of unit peak
    amplitude (`matstd.twin.machine.ranges`).
    """

    symbol: Symbol
    shape: ShapeName
    periods: float = 1.0
    phase: float = 0.0  # phase of the sinusoidal distribution, rad
    sd: float = 1.0  # expected standard deviation of the amplitude, mm or rad

    kind, called = "geometric", "{symbol.title}"
    is_ordinary = True

    @property
    def distribution(self) -> str:
        """Name of the distribution."""
        return self.shape

    @cached_property
    def name(self) -> str:
        """`geometric(EXX,linear)`, `geometric(EXX,sinusoidal,2@90)`: periods, phase in degrees."""
        extra = f",{self.periods:.10g}" if self.periods != 1.0 else ""
        extra += f"@{self.phase / DEG:.10g}" if self.phase else ""
        return f"geometric({self.symbol.name},{self.shape}{extra})"

    @cached_property
    def parameters(self) -> Sequence[Parameter]:
        return (Parameter("amplitude", self.symbol.unit, self.sd),)

    def amounts(self, touches: Touches) -> Amounts:
        return (touches.shape(self.symbol.link, self.shape, self.periods, self.phase),)


def component(chain: Chain, name: str, shape: ShapeName, **options: float) -> ComponentError:
    """Component error by its name; raises UnknownSymbol."""
    return ComponentError(chain.symbol(name), shape, **options)


@dataclass(frozen=True)
class HigherOrder(Declared):
    """One component error of an axis over some degrees, or some harmonics.

    ``E = sum a_k T_k(u)``, or ``sum s_k sin kq + c_k cos kq``, k from `lowest` to `degree`. T_k are
    the Chebyshev polynomials (T_1 and T_2 are the linear and the parabolic distribution) of u, the
    reading scaled to [-1, 1]. Constants are location errors and not in it. Coefficients are
    expected to fall as ``1/k^1.5`` from the size of the class.
    """

    symbol: Symbol
    degree: int
    sd: float  # expected standard deviation of the first coefficient, mm or rad
    rotary: bool = False
    lowest: int = 1

    kind, called = "geometric", "{symbol.title}"
    is_curve = True
    harmonic = 0.0

    @cached_property
    def name(self) -> str:
        """`geometric(EYX,4)`, `geometric(EYX,3-4)`: up to degree 4, and degrees 3 and 4 alone."""
        degrees = f"{self.lowest}-{self.degree}" if self.lowest > 1 else f"{self.degree}"
        return f"geometric({self.symbol.name},{degrees})"

    @property
    def degrees(self) -> range:
        """Every degree that is in it."""
        return range(self.lowest, self.degree + 1)

    @cached_property
    def parameters(self) -> Sequence[Parameter]:
        words = ("sin", "cos") if self.rotary else ("T",)
        unit, each = self.symbol.unit, [(word, k) for k in self.degrees for word in words]
        return tuple(Parameter(f"{word}{k}", unit, self.sd / k**1.5) for word, k in each)

    def amounts(self, touches: Touches) -> Amounts:
        q = touches.reading(self.symbol.link)
        if self.rotary:
            return [f(k * q) for k in self.degrees for f in (np.sin, np.cos)]
        u = touches.chain.link(self.symbol.link).scaled(q)
        return list(chebvander(u, self.degree).T[self.lowest :])


def higher_order(chain: Chain, symbol: Symbol, degree: int, lowest: int = 1) -> HigherOrder:
    """One component error over some degrees, with the prior of the default ranges."""
    rotary = chain.link(symbol.link).kind == "rotary"
    sd = Ranges().sd(chain, symbol)
    return HigherOrder(symbol=symbol, degree=degree, sd=sd, rotary=rotary, lowest=lowest)


def make(chain: Chain, arguments: Sequence[str]) -> Effect:
    """From the component error and a degree, or the name of a distribution."""
    check_count(KIND.usage, arguments, 2, 3)
    symbol = component_symbol(chain, arguments[0])
    rest = ",".join(arguments[1:])
    degrees = _DEGREES.match(rest)
    if degrees is not None:
        lowest, highest = int(degrees[1] or 1), int(degrees[2])
        if 1 <= lowest <= highest <= HIGHEST:
            return higher_order(chain, symbol, highest, lowest)
    match = _SHAPE.match(rest)
    shapes: tuple[ShapeName, ...] = get_args(ShapeName)
    word = next((s for s in shapes if match is not None and s == match.group(1)), None)
    if match is None or word is None:
        expected = f"a degree of 1 to {HIGHEST}, two such as 3-4, or one of {', '.join(shapes)}"
        raise refusal(KIND.usage, arguments, expected)
    periods, phase = float(match[2] or 1.0), float(match[3] or 0.0) * DEG
    return ComponentError(symbol, word, periods, phase, sd=Ranges().sd(chain, symbol))


def propose(touches: Touches) -> Iterable[HigherOrder]:
    """Every component error of an axis that moved, in the degrees beyond the ordinary model.

    That has two of a linear axis and one of a rotary one; a degree that stood in both would have a
    size in neither.
    """
    for symbol in components_of(touches, travelling_axes(touches)):
        lowest = 2 if touches.chain.link(symbol.link).kind == "rotary" else 3
        yield higher_order(touches.chain, symbol, PROPOSED_DEGREE, lowest)


KIND = Kind(
    word="geometric",
    arguments="symbol,degree or shape",
    title="component error of an axis",
    synonyms="positioning, straightness, roll, pitch, yaw, scale error, linear error, "
    "guideway error, run-out, wobble of an axis",
    formula="E = sum a_k T_k(u), k <= n or m <= k <= n (linear axis); "
    "sum s_k sin kq + c_k cos kq (rotary)",
    units="a_k, s_k, c_k: µm or µrad",
    typical="3 to 10 µm, 10 to 40 µrad; old machines ten times that",
    source="ISO 230-1:2012 (component errors); ISO 230-7 (harmonics of an axis of rotation)",
    make=make,
    propose=propose,
    classes=(ComponentError, HigherOrder),
    about="Component error of an axis over its own reading, to some degree or in one distribution.",
)
