"""Component error of one axis that depends on the reading of another: the non-rigid machine."""

from collections.abc import Iterable, Sequence
from dataclasses import dataclass

import numpy as np

from twin.frames import Array
from twin.machine import Chain, Family, Symbol
from twin.model import (
    Kind,
    Parameter,
    Term,
    Title,
    check_count,
    checked_axis,
    component_symbol,
    moving_axes,
    refusal,
)
from twin.record import Touches
from twin.units import UM, URAD


@dataclass(frozen=True)
class Coupling:
    """A component error that depends on the reading of another axis: a bending guide.

    The weight of what travels bends the guide it travels on, more in one place of the other axis
    than in another. This is the lowest joint term: pitch of X that changes with the height of Z is
    ``EBX = a u_X u_Z``, u the reading scaled to [-1, 1].

    Attributes:
        other: Name of the axis it also depends on.
    """

    symbol: Symbol
    other: str

    kind = "coupling"

    @property
    def name(self) -> str:
        """`coupling(EBX,Z)`."""
        return f"coupling({self.symbol.name},{self.other})"

    @property
    def _words(self) -> list[str]:
        """Name of every joint term; an axis whose letter turns gives a cosine and a sine."""
        own, other = (_factor_names(axis) for axis in (self.symbol.link, self.other))
        words = [" ".join(w for w in (f, g) if w) for f in own for g in other]
        return ["amplitude"] if len(words) == 1 else words

    @property
    def title(self) -> Title:
        """In the words of those who run machines."""
        return Title(f"{self.symbol.title}, which changes with {self.other}", self.symbol.link)

    @property
    def parameters(self) -> Sequence[Parameter]:
        """Peak amplitudes."""
        sd = 100 * URAD if self.symbol.is_angular else 10 * UM
        return tuple(Parameter(word, self.symbol.unit, sd) for word in self._words)

    def terms(self, touches: Touches) -> Sequence[Term]:
        """Twists of the axis."""
        where = touches.chain.twist_of(self.symbol)
        own, other = _factors(touches, self.symbol.link), _factors(touches, self.other)
        products = [f * g for f in own for g in other]
        return tuple(Term(k, where, product) for k, product in enumerate(products))


def _factor_names(axis: str) -> tuple[str, ...]:
    return ("",) if axis[0] in "XYZUVW" else (f"cos {axis}", f"sin {axis}")


def _factors(touches: Touches, axis: str) -> tuple[Array, ...]:
    """Lowest functions of one reading, each (N,)."""
    q = touches.reading(axis)
    link = touches.chain.link(axis)
    return (link.scaled(q),) if link.kind == "linear" else (np.cos(q), np.sin(q))


def make(chain: Chain, arguments: Sequence[str]) -> Coupling:
    """From the component error and the other axis."""
    check_count(KIND.usage, arguments, 2, 2)
    symbol = component_symbol(chain, arguments[0])
    other = checked_axis(KIND.usage, arguments, arguments[1], chain)
    if other == symbol.link:
        raise refusal(KIND.usage, arguments, f"another axis than {other} itself")
    return Coupling(symbol, other)


def propose(touches: Touches) -> Iterable[Coupling]:
    """Every angular component of every axis that moved, with every other axis that moved.

    A bending guide turns what stands on it; its straightness that changes with another axis is
    seen through the lever of that turn and need not be proposed apart.
    """
    axes = moving_axes(touches)
    for symbol in touches.chain.symbols:
        if symbol.family is Family.COMPONENT and symbol.is_angular and symbol.link in axes:
            for other in axes:
                if other != symbol.link:
                    yield Coupling(symbol, other)


KIND = Kind(
    word="coupling",
    arguments="symbol,axis",
    title="bending of a guide with another axis",
    synonyms="cross-coupling, non-rigid, quasi-rigid, guideway bending, foundation bending",
    formula="E = a f(q_own) g(q_other); f, g = u (linear axis), cos q and sin q (rotary axis)",
    units="a: µrad or µm",
    typical="10 to 60 µrad over the travel, on slender machines more",
    source="J. S. Chen, Int. J. Mach. Tools Manufact. 35 (1995): pitch of X depends on Z, 58 µrad",
    make=make,
    propose=propose,
    classes=(Coupling,),
)
