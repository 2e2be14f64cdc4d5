"""Variables of touches by name: what a law can be a function of.

`X` is the reading of an axis, `last-X` the sign of its last motion, `time` counts from the start of
the run, `since-setup` and `since-pose` from the first touch of a set-up or a table pose,
`since-switch` from the last change of the spindle speed; `T-spindle` is a temperature,
`trend-T-...` whether it rises, `rpm` the spindle speed, `load` the force on the tool,
`V-coolant_bar` a column of the user's own; `azimuth` and `latitude` say where on the ball of the
probe the contact is.
"""

from dataclasses import dataclass
from typing import Literal

import numpy as np

from matstd.twin.errors import UnknownEffect
from matstd.twin.fields import travelling_axes
from matstd.twin.frames import Array
from matstd.twin.machine import Chain, table_to_tool
from matstd.twin.record import Touches
from matstd.twin.units import HOUR, T_REF
from matstd.twin.words import listed

Nature = Literal["linear", "rotary", "time", "level", "sign"]
"""What a variable is: reading of a linear or rotary axis, a time, a level, one of two signs."""

SENSOR, OWN, LAST, TREND = "T-", "V-", "last-", "trend-"
TIMES = ("time", "since-setup", "since-pose", "since-switch")
ON_BALL = ("azimuth", "latitude")  # where on the ball of the probe a contact is

OTHERS = ("rpm", "load", *ON_BALL)

TREND_TOUCHES = 9
"""Touches over which a temperature rises or falls: its last digit is a millikelvin."""


@dataclass(frozen=True)
class Driver:
    """One variable, whatever the touches."""

    name: str  # as it stands in the name of a law
    nature: Nature
    unit: str  # base unit: mm, rad, s, degC; "" for a number
    zero: float = 0.0  # its natural zero: the middle of the travel, 20 degC, the start
    scale: float = 1.0  # what one unit of a polynomial is: half the travel, an hour, a kelvin

    def values(self, touches: Touches) -> Array:
        """The variable at every touch, (N,), base unit; raises UnknownEffect if not recorded."""
        name = self.name
        if name in touches.chain.axes:
            return touches.reading(name)
        if name.startswith(LAST):
            return touches.last_move(name.removeprefix(LAST))
        if name.startswith(TREND):
            return _trend(_recorded(touches, name.removeprefix(TREND)))
        if name in TIMES:
            return _elapsed(touches, name)
        if name in ON_BALL:
            return _on_ball(touches)[name == "latitude"]
        return _recorded(touches, name)


CLOCK = Driver("time", "time", "s", 0.0, HOUR)
"""Time of a run, of which another run has no record: its instants are those of one run."""


def driver_of(name: str, chain: Chain) -> Driver:
    """The variable of a name; raises UnknownEffect."""
    if name in chain.programmed_axes:
        link = chain.link(name)
        low, high = link.range
        if link.kind == "rotary":
            return Driver(name, "rotary", "rad")
        return Driver(name, "linear", "mm", 0.5 * (low + high), 0.5 * (high - low))
    if name.startswith(LAST) and name.removeprefix(LAST) in chain.programmed_axes:
        return Driver(name, "sign", "")
    if name.startswith(TREND + SENSOR):
        return Driver(name, "sign", "")
    if name in TIMES:
        return Driver(name, "time", "s", 0.0, HOUR)
    if name.startswith(SENSOR):
        return Driver(name, "level", "degC", T_REF, 1.0)
    if name.startswith(OWN) or name in ("load",):
        return Driver(name, "level", "N" if name == "load" else "")
    if name == "rpm":
        return Driver(name, "level", "1/min", 0.0, 1000.0)
    if name in OTHERS:
        return Driver(name, "rotary", "rad")
    known = [*chain.programmed_axes, *(LAST + a for a in chain.programmed_axes), *TIMES, *OTHERS]
    raise UnknownEffect(
        f"'{name}' is no variable of a law; available: {listed(known, 'or')}, a temperature such "
        "as T-spindle, trend-T-spindle, or a column such as V-coolant_bar"
    )


def drivers(touches: Touches) -> list[Driver]:
    """Every variable that these touches offer: recorded, without gaps, with two values at least."""
    chain = touches.chain
    is_switched = touches.spindle_rpm is not None and np.ptp(touches.spindle_rpm) > 0.0
    times = TIMES if is_switched else TIMES[:-1]
    names = [*travelling_axes(touches), *(LAST + a for a in chain.programmed_axes), *times]
    names += [SENSOR + s for s in touches.temperature]
    names += [TREND + SENSOR + s for s in touches.temperature]
    names += [OWN + column for column in touches.value]
    names += ["rpm"] if touches.spindle_rpm is not None else []
    names += ["load"] if touches.force is not None else []
    names += [*ON_BALL] if touches.instrument.is_ball_on_standard else []
    every = [driver_of(name, chain) for name in names]
    out: list[Driver] = []
    seen: list[Array] = []
    for driver in every:
        values = driver.values(touches)
        if not np.all(np.isfinite(values)) or np.ptp(values) <= 1e-6 * max(driver.scale, 1e-9):
            continue
        # a temperature that turns once says no more than an instant, and hid a step over time
        if driver.name.startswith(TREND) and _turns(values) < 2:
            continue
        # a second name of the same variable, such as the time since the only set-up, says nothing
        if any(np.array_equal(values, other) for other in seen):
            continue
        seen.append(values)
        out.append(driver)
    return out


def _recorded(touches: Touches, name: str) -> Array:
    """A temperature, a column of the user's own, the speed of the spindle or the load."""
    if name == "rpm" and touches.spindle_rpm is not None:
        return touches.spindle_rpm
    if name == "load" and touches.force is not None:
        return np.asarray(np.linalg.norm(touches.force, axis=1))
    sensor, own = name.removeprefix(SENSOR), name.removeprefix(OWN)
    if name.startswith(SENSOR) and sensor in touches.temperature:
        return touches.temperature[sensor]
    if name.startswith(OWN) and own in touches.value:
        return touches.value[own]
    known = [SENSOR + s for s in touches.temperature] + [OWN + s for s in touches.value]
    there = listed(known, "and") if known else "none"
    raise UnknownEffect(f"'{name}' is not recorded in these touches; recorded: {there}")


def _elapsed(touches: Touches, name: str) -> Array:
    """Time since the start of the run, or since the first touch of what a touch belongs to, s."""
    time = touches.since_start
    if name == "time":
        return time
    if name == "since-switch":
        rpm = touches.spindle_rpm
        is_new = (
            np.zeros(len(time), dtype=bool) if rpm is None else np.diff(rpm, prepend=rpm[:1]) != 0
        )
        label = np.cumsum(is_new)
    else:
        changed = np.diff(touches.setup, prepend=touches.setup[:1]) != 0
        if name == "since-pose":
            changed |= np.diff(touches.pose, prepend=touches.pose[:1]) != 0
        label = np.cumsum(changed)
    first = np.full(int(label.max(initial=0)) + 1, np.inf)
    np.minimum.at(first, label, time)
    return np.asarray(time - first[label])


def _trend(values: Array) -> Array:
    """Sign of the change of a record over some touches, (N,)."""
    half = TREND_TOUCHES // 2
    padded = np.pad(values, half, mode="edge")
    return np.asarray(np.sign(padded[2 * half :] - padded[: -2 * half]))


def _turns(trend: Array) -> int:
    """How often a record rises after it fell, or falls after it rose."""
    return int(np.count_nonzero(np.diff(trend[trend != 0.0])))


def _on_ball(touches: Touches) -> tuple[Array, Array]:
    """Azimuth and latitude of the contact in the tool frame, rad, (N,) each."""
    tool = np.swapaxes(table_to_tool(touches.chain, touches.q)[:, :3, :3], 1, 2)
    normal = np.einsum("nij,nj->ni", tool, touches.normal_table)
    azimuth = np.arctan2(normal[:, 1], normal[:, 0])
    return azimuth, np.arcsin(np.clip(normal[:, 2], -1.0, 1.0))
