"""What an effect may follow: a sensor, the spindle speed, or a column of the user's own."""

from collections.abc import Iterable

import numpy as np

from twin.errors import UnknownEffect
from twin.frames import Array
from twin.model import sensor_record, sensors, varies
from twin.record import Touches
from twin.thermal.thermal_lag import SPEED_UNIT, SPINDLE, lagged
from twin.units import T_REF
from twin.words import did_you_mean

PER_KELVIN = 0.2
"""Usual size of an error per kelvin, over that at 10 000 rpm, as of `thermal-lag`."""


def drives(touches: Touches) -> list[str]:
    """Names of the recorded drives of warmth that vary: sensors, then the spindle speed."""
    rpm = touches.spindle_rpm
    return [*sensors(touches), *([SPINDLE] if rpm is not None and varies(rpm) else [])]


def is_speed(drive: str) -> bool:
    """Whether a drive is the spindle speed and not a sensor."""
    return drive == SPINDLE


def driven(touches: Touches, drive: str, tau: float, effect: str) -> Array:
    """What has followed of a drive with a time constant at every touch, (N,).

    Args:
        drive: A sensor, followed as its difference from 20 degC, or `spindle_rpm` in units of
            10 000 rpm.
        tau: Time constant, s; zero follows at once.
        effect: Who asks, for the message.

    Raises:
        UnknownEffect: The drive was not recorded.
    """
    if is_speed(drive):
        if touches.spindle_rpm is None:
            raise UnknownEffect(f"'{effect}': the spindle speed of these touches is unknown")
        speed = touches.spindle_rpm / SPEED_UNIT
        return lagged(touches, speed, tau, steps=True) if tau > 0.0 else speed
    warmth = sensor_record(touches, drive) - T_REF
    return lagged(touches, warmth, tau) if tau > 0.0 else warmth


def own_column(touches: Touches, name: str) -> Array:
    """A column of the user's own by its name without `V_`, (N,); raises UnknownEffect."""
    if name not in touches.value:
        known = ", ".join(touches.value) or "none"
        meant = did_you_mean(name, touches.value)
        raise UnknownEffect(f"no column 'V_{name}' in these touches{meant}; there is {known}")
    return touches.value[name]


def own_columns(touches: Touches) -> Iterable[str]:
    """Names of the user's own columns that vary."""
    return [name for name, values in touches.value.items() if varies(np.asarray(values))]
