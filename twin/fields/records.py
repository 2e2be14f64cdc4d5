"""Arguments that touches offer to effects: axes that moved, their component errors, sensors."""

from collections.abc import Iterator

import numpy as np

from matstd.twin.errors import UnknownEffect
from matstd.twin.frames import Array
from matstd.twin.machine import Family, Symbol
from matstd.twin.record import Touches
from matstd.twin.words import did_you_mean


def moving_axes(touches: Touches) -> list[str]:
    """Programmed axes that stood at more than one reading, in chain order."""
    return [axis for axis in touches.chain.programmed_axes if np.ptp(touches.reading(axis)) > 1e-6]


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
        raise UnknownEffect(
            f"no temperature sensor '{sensor}' in these touches{meant}; there is {known}"
        )
    return touches.temperature[sensor]
