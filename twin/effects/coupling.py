"""Component error of one axis that depends on the reading of another: the non-rigid machine."""

from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import Annotated, Self

import numpy as np
from numpy.polynomial.legendre import legvander

from matstd.twin.fields import (
    Argument,
    AxisName,
    ComponentSymbol,
    Refuse,
    components_of,
    travelling_axes,
)
from matstd.twin.frames import Array
from matstd.twin.machine import Chain
from matstd.twin.model import Amounts, Declared, Kind, Parameter
from matstd.twin.record import Touches
from matstd.twin.units import UM, URAD

DEGREES = ("1", "2", "3", "4")
"""Degrees of a coupling: no guide bends in more waves, and no run resolves them."""


def _degree(text: str, chain: Chain, refuse: Refuse) -> int:
    if text not in DEGREES:
        raise refuse(f"a degree of {', '.join(DEGREES)}")
    return int(text)


@dataclass(frozen=True)
class Coupling(Declared):
    """A component error that depends on the reading of another axis: a bending guide.

    The weight of what travels bends the guide it travels on, more in one place of the other axis
    than in another. The lowest joint term is enough for most: pitch of X that changes with the
    height of Z is ``EBX = a u_X u_Z``, u the reading scaled to [-1, 1]. Of a higher degree n it is
    any function of both, ``sum a_jk P_j(u_X) P_k(u_Z)``, j and k from 1 to n, P of Legendre (of an
    axis that turns, cosine and sine of its multiples): what each axis does by itself stays its own.
    """

    symbol: ComponentSymbol
    other: AxisName  # name of the axis it also depends on
    degree: Annotated[int, Argument("degree", _degree)] = 1

    kind, called = "coupling", "{symbol.title}, which changes with {other}"
    usual = (10 * UM, 100 * URAD)

    def on(self, chain: Chain, refuse: Refuse) -> Self:
        """With another axis than its own."""
        if self.other == self.symbol.link:
            raise refuse(f"another axis than {self.other} itself")
        return self

    @cached_property
    def parameters(self) -> Sequence[Parameter]:
        own, other = (_functions(a, self.degree) for a in (self.symbol.link, self.other))
        # guides are smooth: a shape of order j k is expected that much smaller
        return tuple(
            self.sized(f"{f} {g}".strip() or "amplitude", 1.0 / (j * k))
            for f, j in own
            for g, k in other
        )

    def amounts(self, touches: Touches) -> Amounts:
        own, other = (_factors(touches, a, self.degree) for a in (self.symbol.link, self.other))
        return [f * g for f in own for g in other]


def _functions(axis: str, degree: int) -> list[tuple[str, int]]:
    """Name and order of every function of one reading; of an axis that turns cosine and sine."""
    orders = range(1, degree + 1)
    if axis[0] in "XYZUVW":
        return [(f"P{k}{axis}" if degree > 1 else "", k) for k in orders]
    number = "{}" if degree > 1 else ""
    return [(f"{f} {number.format(k)}{axis}", k) for k in orders for f in ("cos", "sin")]


def _factors(touches: Touches, axis: str, degree: int) -> tuple[Array, ...]:
    """Functions of one reading from the lowest on, each (N,)."""
    q = touches.reading(axis)
    link = touches.chain.link(axis)
    if link.kind == "linear":
        return tuple(legvander(link.scaled(q), degree).T[1:])
    return tuple(f(k * q) for k in range(1, degree + 1) for f in (np.cos, np.sin))


def propose(touches: Touches) -> Iterable[Coupling]:
    """Every angular component of every axis that moved, with every other axis that moved.

    A bending guide turns what stands on it; its straightness that changes with another axis is
    seen through the lever of that turn and need not be proposed apart.
    """
    axes = travelling_axes(touches)
    for symbol in components_of(touches, axes):
        for other in axes:
            if symbol.is_angular and other != symbol.link:
                yield Coupling(symbol, other)


KIND = Kind.of(
    Coupling,
    title="bending of a guide with another axis",
    synonyms="cross-coupling, non-rigid, quasi-rigid, guideway bending, foundation bending",
    formula="E = a f(q_own) g(q_other); f, g = u (linear axis), cos q and sin q (rotary axis); of "
    "degree n: sum a_jk P_j(u_own) P_k(u_other), j, k = 1 ... n",
    units="a: µrad or µm",
    typical="10 to 60 µrad over the travel, on slender machines more",
    source="J. S. Chen, Int. J. Mach. Tools Manufact. 35 (1995): pitch of X depends on Z, 58 µrad",
    propose=propose,
)
