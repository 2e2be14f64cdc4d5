"""Fields of effects: the types by which a kind states once what stands in its brackets.

A field of an effect is annotated with one of them, `axis: LinearAxisName`; the parser, the usage,
the name and the proposals of its kind follow. Below the effects themselves: axes, component errors
and sensors by name, and which of them some touches offer.
"""

from collections.abc import Callable, Iterable, Iterator, Sequence
from dataclasses import dataclass
from typing import Annotated, Any

import numpy as np

from matstd.twin.errors import UnknownEffect
from matstd.twin.frames import Array
from matstd.twin.machine import Chain, Family, Symbol
from matstd.twin.record import Touches
from matstd.twin.words import did_you_mean

LEAST_TRAVEL = 20.0
"""Ratio of the travel of an axis to the median deviation along it above which errors are
functions of it. A plane through a step rises up to eight times the median deviation from it."""


def moving_axes(touches: Touches) -> list[str]:
    """Programmed axes that stood at more than one reading, in chain order."""
    return [axis for axis in touches.chain.programmed_axes if np.ptp(touches.reading(axis)) > 1e-6]


def travelling_axes(touches: Touches) -> list[str]:
    """Those that travelled far enough for an error that is a function of their reading.

    The commanded readings of a level plate follow the same deviations that are to be explained: a
    step over X inclines them by micrometres, over which a wave of Z would imitate it.
    """
    if touches.commanded is None:
        return moving_axes(touches)
    off = np.median(np.abs(touches.q - touches.commanded), axis=0)
    least = dict(zip(touches.chain.axes, LEAST_TRAVEL * off, strict=True))
    return [axis for axis in moving_axes(touches) if np.ptp(touches.reading(axis)) > least[axis]]


def moving_linear_axes(touches: Touches) -> list[str]:
    """The linear ones among them."""
    return [axis for axis in moving_axes(touches) if axis in touches.chain.linear_axes]


def components_of(touches: Touches, axes: list[str]) -> Iterator[Symbol]:
    """Component errors of some axes, in the order of the machine's symbols."""
    for symbol in touches.chain.symbols:
        if symbol.family is Family.COMPONENT and symbol.link in axes:
            yield symbol


def moved_components(touches: Touches) -> Iterator[Symbol]:
    """Component errors of the axes that moved, in the order of the machine's symbols.

    Where nothing moved, as in front of a nest of displacement probes, the axis next to the tool
    stands for the machine.
    """
    return components_of(touches, moving_axes(touches) or list(touches.chain.axes[-1:]))


def changing_components(touches: Touches) -> Iterator[Symbol]:
    """Component errors that may change with time or a driver, in the order of the symbols.

    Those of the axes that moved, and of the axis next to the tool where a head turned: errors of an
    axis keep the directions of the machine, and a spindle grows along the tool (ISO 230-3).
    """
    moving, chain = moving_axes(touches), touches.chain
    is_turned = any(axis in moving for axis in chain.tool_rotary_axes)
    return components_of(touches, [*moving, chain.axes[-1]] if is_turned or not moving else moving)


def varies(values: Array) -> bool:
    """Whether a record has more than one value, and no gap."""
    return bool(np.all(np.isfinite(values)) and np.ptp(values) > 1e-6)


def sensors(touches: Touches) -> list[str]:
    """Sensors whose record varies and has no gap."""
    return [name for name, values in touches.temperature.items() if varies(values)]


def sensor_record(touches: Touches, sensor: str) -> Array:
    """Temperatures of one sensor, (N,), degC; raises UnknownEffect where there is none."""
    if sensor not in touches.temperature:
        known = ", ".join(touches.temperature) or "none"
        meant = did_you_mean(sensor, touches.temperature)
        raise UnknownEffect(f"no temperature sensor '{sensor}'{meant}; there is {known}")
    return touches.temperature[sensor]


Refuse = Callable[[str], UnknownEffect]
"""Makes the exception from what should stand there, with what is available."""


def no_values(touches: Touches) -> Iterable[Any]:
    """Nothing to propose: the value is the user's to state."""
    return ()


def _as_it_is(text: str, chain: Chain, refuse: Refuse) -> str:
    return text


@dataclass(frozen=True)
class Argument:
    """What may stand at one place between the brackets of an effect's name."""

    word: str  # what it is, for the usage
    # value of a text on a machine; raises what `Refuse` makes, or another DesignError
    read: Callable[[str, Chain, Refuse], Any] = _as_it_is
    write: Callable[[Any], str] = str  # text of a value
    # values that make sense for some touches
    offered: Callable[[Touches], Iterable[Any]] = no_values


def refusal(usage: str, found: Sequence[str], expected: str) -> UnknownEffect:
    """Exception for arguments that an effect does not take; expected is what is available."""
    word = usage.partition("(")[0]
    given = f"{word}({','.join(found)})" if found else word
    return UnknownEffect(f"effect '{given}': expected {usage}, {expected}")


def check_count(usage: str, arguments: Sequence[str], low: int, high: int) -> None:
    """Check the number of arguments; raises UnknownEffect."""
    if not low <= len(arguments) <= high:
        number = f"{low or 'no'}" if low == high else f"{low} to {high}"
        raise refusal(usage, arguments, f"{number} argument{'' if high == 1 else 's'}")


def component_symbol(chain: Chain, name: str) -> Symbol:
    """Component error of an axis by its name; raises UnknownSymbol or UnknownEffect."""
    symbol = chain.symbol(name)
    if symbol.family is not Family.COMPONENT:
        raise UnknownEffect(
            f"'{name}' is a constant ({symbol.family.value}); expected a component error of an "
            "axis, such as EXX"
        )
    return symbol


def read_axis(text: str, chain: Chain, refuse: Refuse) -> str:
    """A programmed axis."""
    if text not in chain.programmed_axes:
        raise refuse(f"an axis of {', '.join(chain.programmed_axes)}")
    return text


def read_linear_axis(text: str, chain: Chain, refuse: Refuse) -> str:
    """A programmed linear axis."""
    if text not in chain.linear_axes:
        raise refuse(f"a linear axis of {', '.join(chain.linear_axes)}")
    return text


def _name_of(symbol: Symbol) -> str:
    return symbol.name


AnySymbol = Annotated[
    Symbol, Argument("symbol", lambda text, chain, refuse: chain.symbol(text), _name_of)
]
"""Any error parameter: `EXX`, `EC0Y`, `EX0w`."""
AxisName = Annotated[str, Argument("axis", read_axis, offered=moving_axes)]
"""A programmed axis; offered are those that moved."""
LinearAxisName = Annotated[str, Argument("axis", read_linear_axis, offered=moving_linear_axes)]
"""A programmed linear axis; offered are those that moved."""
ComponentSymbol = Annotated[
    Symbol,
    Argument(
        "symbol",
        lambda text, chain, refuse: component_symbol(chain, text),
        _name_of,
        moved_components,
    ),
]
"""A component error of an axis; offered are those of the axes that moved."""
SensorName = Annotated[str, Argument("sensor", offered=sensors)]
"""A temperature sensor; offered are those whose record varies."""
