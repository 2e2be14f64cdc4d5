"""Errors that repeat: the pitch of a screw or scale, the higher harmonics of a rotary axis."""

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np

from twin.machine import Chain, Family, Symbol
from twin.model import (
    Inner,
    Kind,
    Parameter,
    Term,
    Title,
    Where,
    check_count,
    component_symbol,
    moving_axes,
)
from twin.record import Touches
from twin.units import UM, URAD

SHORTEST, LONGEST = 1.0, 50.0
"""Periods that are scanned on a linear axis, mm."""
OVERSAMPLING = 3.0
"""Scanned frequencies per resolvable one; the nearest keeps 95 % of a sine between two of them."""
HIGHEST_HARMONIC = 12
"""A period of 30 degrees, which 26 distinct readings of the axis can tell from its neighbours."""


@dataclass(frozen=True)
class Periodic:
    """A sine of free phase and unknown period p over a linear axis.

    Screw and nut, or scale and head, repeat every pitch.

    Attributes:
        symbol: The component error.
        period: p, mm.
    """

    symbol: Symbol
    period: float = 10.0

    kind = "periodic"

    @property
    def name(self) -> str:
        """`periodic(EXX)`."""
        return f"periodic({self.symbol.name})"

    @property
    def title(self) -> Title:
        """In the words of those who run machines."""
        return Title(f"{self.symbol.title}, which repeats", self.symbol.link)

    @property
    def parameters(self) -> Sequence[Parameter]:
        """Sine and cosine."""
        return _sine_and_cosine(self.symbol)

    def terms(self, touches: Touches) -> Sequence[Term]:
        """Twists of the axis."""
        return _wave(touches, self.symbol, 2.0 * np.pi / self.period)

    def inner(self, touches: Touches) -> Sequence[Inner]:
        """The period, evenly spaced in frequency, fine enough for the travel that was covered."""
        travel = max(float(np.ptp(touches.reading(self.symbol.link))), LONGEST)
        low, high = 1.0 / min(LONGEST, travel / 2.0), 1.0 / SHORTEST
        count = int(np.ceil(OVERSAMPLING * travel * (high - low))) + 1
        grid = 1.0 / np.linspace(high, low, count)
        return (Inner("period", "mm", grid, acts="with a period"),)

    def tuned(self, *values: float) -> "Periodic":
        """With this period, mm."""
        return replace(self, period=float(values[0]))

    @property
    def tuning(self) -> Mapping[str, float]:
        """The period, mm."""
        return {"period": self.period}


@dataclass(frozen=True)
class Harmonic:
    """One harmonic, the second or a higher one, of a component error of a rotary axis.

    ``E = s sin(k q) + c cos(k q)``, k = 2, 3 ...; k = 1 is eccentricity and tilt, part of every
    geometric model. k = 2 comes from two reading heads or an oval seat, 4 from four screws, the
    line count from the encoder.

    Attributes:
        symbol: The component error.
        harmonic: k.
    """

    symbol: Symbol
    harmonic: float = 2.0

    kind = "periodic"

    @property
    def name(self) -> str:
        """`periodic(EXC)`."""
        return f"periodic({self.symbol.name})"

    @property
    def title(self) -> Title:
        """In the words of those who run machines."""
        return Title(f"{self.symbol.title}, which repeats", self.symbol.link)

    @property
    def parameters(self) -> Sequence[Parameter]:
        """Sine and cosine."""
        return _sine_and_cosine(self.symbol)

    def terms(self, touches: Touches) -> Sequence[Term]:
        """Twists of the axis."""
        return _wave(touches, self.symbol, self.harmonic)

    def inner(self, touches: Touches) -> Sequence[Inner]:
        """The harmonic, as far as the distinct readings of the axis can tell one from another."""
        readings = np.unique(np.round(touches.reading(self.symbol.link), 4))
        highest = int(np.clip(len(readings) // 2 - 1, 2, HIGHEST_HARMONIC))
        return (Inner("harmonic", "1", np.arange(2.0, highest + 1.0), continuous=False),)

    def tuned(self, *values: float) -> "Harmonic":
        """With this harmonic."""
        return replace(self, harmonic=float(values[0]))

    @property
    def tuning(self) -> Mapping[str, float]:
        """The harmonic."""
        return {"harmonic": self.harmonic}


def _sine_and_cosine(symbol: Symbol) -> Sequence[Parameter]:
    sd = 20 * URAD if symbol.is_angular else 3 * UM
    return tuple(Parameter(word, symbol.unit, sd) for word in ("sin", "cos"))


def _wave(touches: Touches, symbol: Symbol, factor: float) -> Sequence[Term]:
    """Sine and cosine of factor times the reading, as a twist of the axis."""
    where = Where("twist", touches.chain.link_index(symbol.link), symbol.component)
    argument = factor * touches.reading(symbol.link)
    return (Term(0, where, np.sin(argument)), Term(1, where, np.cos(argument)))


def make(chain: Chain, arguments: Sequence[str]) -> Periodic | Harmonic:
    """From the component error."""
    check_count(KIND.usage, arguments, 1, 1)
    symbol = component_symbol(chain, arguments[0])
    return Periodic(symbol) if chain.link(symbol.link).kind == "linear" else Harmonic(symbol)


def propose(touches: Touches) -> Iterable[Periodic | Harmonic]:
    """Positioning of every linear axis that moved; every component of a rotary axis."""
    chain, axes = touches.chain, moving_axes(touches)
    for symbol in chain.symbols:
        if symbol.family is not Family.COMPONENT or symbol.link not in axes:
            continue
        if chain.link(symbol.link).kind == "rotary":
            yield Harmonic(symbol)
        elif symbol.component == chain.link(symbol.link).own_component:
            yield Periodic(symbol)


KIND = Kind(
    word="periodic",
    arguments="symbol",
    title="screw pitch and other periodic errors",
    synonyms="pitch error, ball screw, lead error, cyclic error, encoder, interpolation "
    "error, graduation, wobble",
    formula="E = s sin(2 pi q/p) + c cos(2 pi q/p), p unknown (linear); k q, k >= 2 (rotary)",
    units="s, c: µm or µrad; p: mm; k: 1",
    typical="0.5 to 3 µm at the pitch of a ground ball screw, up to 10 µm of others; rotary 0.1 to "
    "1 µm, 5 to 20 µrad",
    source="ISO 230-2 and the makers' data of feed axes; ISO 230-7 (axes of rotation)",
    make=make,
    propose=propose,
    classes=(Periodic, Harmonic),
    about="Error that repeats: pitch of a screw or scale, higher harmonics of a rotary axis.",
)
