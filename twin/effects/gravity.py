"""Sag under moved weight: rams, heads, cradles, loads off centre."""

from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from functools import partial

import numpy as np

from matstd.twin.fields import (
    AxisName,
    ComponentSymbol,
    check_count,
    component_symbol,
    moving_axes,
    read_axis,
    refusal,
)
from matstd.twin.machine import Chain, Family, Symbol
from matstd.twin.model import Amounts, Declared, Effect, Kind
from matstd.twin.record import Touches
from matstd.twin.units import UM, URAD


@dataclass(frozen=True)
class _Sag(Declared):
    """A component error in proportion to the weight that an axis carries about."""

    symbol: ComponentSymbol

    kind = "gravity"
    usual = (20 * UM, 100 * URAD)


@dataclass(frozen=True)
class RamSag(_Sag):
    """Sag of a ram or column that travels out of its guide.

    ``E = a s^3``, s the overhang as a share of the travel: a cantilever under a load at its end
    sags by ``F L^3/(3 E I)``.

    Attributes:
        symbol: The component error, across the axis for a sag.
    """

    called = "sag of {symbol.link} {symbol.motion}"

    def amounts(self, touches: Touches) -> Amounts:
        low, high = touches.chain.link(self.symbol.link).range
        overhang = (high - touches.reading(self.symbol.link)) / (high - low)
        return (overhang**3,)


@dataclass(frozen=True)
class TiltSag(_Sag):
    """Sag of a head or cradle that tilts its own weight.

    ``E = a sin 2q``. The weight pulls with m g sin q across and m g cos q along the tilted body;
    the arm that its sag across gives the pull along makes the product of both (P-delta). What the
    weight does in the first harmonic looks like `geometric(EBB,1)` and belongs there.
    """

    called = "sag of {symbol.link} under its own weight"

    def amounts(self, touches: Touches) -> Amounts:
        return (np.sin(2.0 * touches.reading(self.symbol.link)),)


@dataclass(frozen=True)
class OffCentreLoad(_Sag):
    """Tilt of a cradle under a load that lies off the centre of the table it carries.

    ``E = sin(q_tilt) (a cos(q_table) + b sin(q_table))``: the moment ``m g r sin B cos(C - phi)``.
    """

    table: AxisName  # name of the axis that turns the load

    called = "tilt under a load off the centre of {table}"
    amplitudes = ("cos", "sin")  # of the load in phase with the table and a quarter turn on
    usual = (10 * UM, 30 * URAD)

    def amounts(self, touches: Touches) -> Amounts:
        tilt, turn = np.sin(touches.reading(self.symbol.link)), touches.reading(self.table)
        return (tilt * np.cos(turn), tilt * np.sin(turn))


def make(chain: Chain, arguments: Sequence[str]) -> Effect:
    """From the component error, and the axis of the table for a load off its centre."""
    check_count(KIND.usage, arguments, 1, 2)
    symbol = component_symbol(chain, arguments[0])
    rotary = chain.link(symbol.link).kind == "rotary"
    if len(arguments) == 1:
        return TiltSag(symbol) if rotary else RamSag(symbol)
    refuse = partial(refusal, KIND.usage, arguments)
    table = read_axis(arguments[1], chain, refuse)
    if not rotary or table not in chain.rotary_axes or table == symbol.link:
        raise refuse("a rotary axis that tilts and another that turns the load")
    return OffCentreLoad(symbol, table)


def propose(touches: Touches) -> Iterable[Effect]:
    """Straightness of linear axes, own rotation of tilting axes, loads on tables that they carry.

    An axis that turns about the vertical of the machine does not tilt what it carries.
    """
    chain, axes = touches.chain, moving_axes(touches)
    for axis in axes:
        own = chain.link(axis).own_component
        if axis in chain.linear_axes:
            for component in (i for i in range(3) if i != own):
                yield RamSag(Symbol(component, axis, Family.COMPONENT))
        elif abs(chain.link(axis).direction[2]) < 0.9:
            yield TiltSag(Symbol(own, axis, Family.COMPONENT))
            for table in _carried_tables(chain, axis):
                if table in axes:
                    yield OffCentreLoad(Symbol(own, axis, Family.COMPONENT), table)


def _carried_tables(chain: Chain, axis: str) -> list[str]:
    """Rotary axes between an axis and the workpiece it carries."""
    if not chain.link(axis).carries_workpiece:
        return []
    inner = chain.links[: chain.link_index(axis)]
    return [link.name for link in inner if link.kind == "rotary"]


KIND = Kind(
    word="gravity",
    arguments="symbol[,axis]",
    title="sag under weight",
    synonyms="droop, overhang, ram sag, deflection, weight, table load, unbalanced load",
    formula="E = a s^3, s = (q_max - q)/travel (ram); a sin 2q (head, cradle); "
    "sin B (a cos C + b sin C) (load off centre)",
    units="a, b: µm or µrad",
    typical="ram 1 to 10 µm; cradle 10 to 50 µrad at rated load, slender heads more; load off "
    "centre 10 µrad",
    source="Euler-Bernoulli cantilever; moment of a weight over the stiffness that holds it",
    make=make,
    propose=propose,
    classes=(RamSag, TiltSag, OffCentreLoad),
    about="Sag under the weight that the axes carry about.",
)
