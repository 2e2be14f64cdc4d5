"""Drives that an effect may follow: a sensor, the spindle speed, or a column of the user's own.

A body that is driven settles with its own time constant. What drives it is recorded at the touches
only, so the equation is integrated exactly for a drive that is straight between two records (or
constant, for the spindle speed), over whatever times the touches were made at.
"""

from typing import Annotated
from weakref import WeakKeyDictionary

import numpy as np

from matstd.twin.errors import UnknownEffect
from matstd.twin.fields import Argument, Refuse, sensor_record, sensors, varies
from matstd.twin.frames import Array
from matstd.twin.machine import Chain
from matstd.twin.model import Inner
from matstd.twin.record import Touches
from matstd.twin.units import T_REF
from matstd.twin.words import did_you_mean

SPINDLE = "spindle_rpm"  # the drive that is no sensor: the spindle speed of the run file
SPEED_UNIT = 1.0e4  # amplitudes after the spindle speed are those at 10 000 rpm, 1/min
CYCLE = "cycle_1"  # own column that counts the cycles of a positioning test, as import writes it
PROGRESS = "cycles_done_1"
"""Own column beside it: cycles that were done when a reading was taken, parts of them included."""
OWN = "V_"  # begins a drive that is a column of the user's own, as in the run file
PER_KELVIN = 0.2
"""Usual size of an error per kelvin, over that at 10 000 rpm or after a step of an own column."""


MAX_CACHED_RESPONSES = 64
"""Responses cached for one record: one drive with every time constant of a grid."""
_RESPONSES: WeakKeyDictionary[Touches, dict[tuple[str, float, float], Array]] = WeakKeyDictionary()
"""Responses by drive, time constant and step. Every component error of every axis uses the same
ones; without the cache a search spent a tenth of its time here."""


def drives(touches: Touches) -> list[str]:
    """Names of the recorded drives that vary: sensors, the spindle speed, the user's own columns.

    Those of the user's own stand as in the run file, `V_coolant_bar`.
    """
    rpm = touches.spindle_rpm
    speed = [SPINDLE] if rpm is not None and varies(rpm) else []
    return [
        *sensors(touches),
        *speed,
        *(f"{OWN}{c}" for c, v in touches.value.items() if varies(v)),
    ]


def _clock_name(text: str, chain: Chain, refuse: Refuse) -> str:
    if not is_own(text):
        raise refuse("an own column V_name_unit that grows with time")
    return text


Clock = Annotated[str, Argument("V_column that grows with time", _clock_name)]
"""Own column `V_name` that grows in step with time; empty for the time itself."""


def clocks(touches: Touches) -> list[str]:
    """What counts the time of a run: its times, or the order of a test without times."""
    own = [OWN + PROGRESS] if PROGRESS in touches.value else []
    return ["", *own] if np.ptp(touches.since_start) > 0.0 else own


def is_speed(drive: str) -> bool:
    """Whether a drive is the spindle speed and not a sensor."""
    return drive == SPINDLE


def is_own(drive: str) -> bool:
    """Whether a drive is a column of the user's own."""
    return drive.startswith(OWN)


def amplitude_unit(drive: str, unit: str, sd: float) -> tuple[str, float]:
    """Unit of the amplitude after a drive, and its usual size.

    Per kelvin after a sensor; at 10 000 rpm after the speed; of a step of an own column.

    Args:
        drive: The drive; empty for switching on.
        unit: Unit of the error, "mm" or "rad".
        sd: Usual size of the error at 10 000 rpm.
    """
    if not drive or is_speed(drive):
        return unit, sd
    return (unit if is_own(drive) else f"{unit}/K"), PER_KELVIN * sd


def driven(touches: Touches, drive: str, tau: float, effect: str, step: float = 1.0) -> Array:
    """Response to a drive with a time constant at every touch, (N,); raises UnknownEffect.

    Args:
        drive: A sensor, followed as its difference from 20 degC, `spindle_rpm` in units of
            10 000 rpm, or an own column in units of a step.
        tau: Time constant, s; zero follows at once.
        effect: Name of the effect, for the message.
        step: Step of the user's own column, in its unit.
    """
    if is_speed(drive) and touches.spindle_rpm is None:
        raise UnknownEffect(f"'{effect}': the spindle speed of these touches is unknown")
    known = _RESPONSES.setdefault(touches, {})
    key = (drive, tau, step)
    if key not in known:
        if len(known) >= MAX_CACHED_RESPONSES:
            known.clear()
        known[key] = _driven(touches, drive, tau, step)
        known[key].flags.writeable = False
    return known[key]


def _driven(touches: Touches, drive: str, tau: float, step: float) -> Array:
    """The same, worked out."""
    if is_speed(drive):
        record = np.asarray(touches.spindle_rpm) / SPEED_UNIT
    elif is_own(drive):
        record = own_column(touches, drive.removeprefix(OWN)) / step
    else:
        record = sensor_record(touches, drive) - T_REF
    return lagged(touches, record, tau, is_speed(drive)) if tau > 0.0 else record.copy()


def own_column(touches: Touches, name: str) -> Array:
    """A column of the user's own by its name without `V_`, (N,); raises UnknownEffect."""
    if name not in touches.value:
        known = ", ".join(touches.value) or "none"
        meant = did_you_mean(name, touches.value)
        raise UnknownEffect(f"no column 'V_{name}'{meant}; there is {known}")
    return touches.value[name]


def step_of(touches: Touches, drive: str) -> float:
    """The step in which an own column is followed; 1 of any other drive.

    Example:
        A pressure that goes from 20 to 40 bar is followed in steps of 10 bar.
    """
    return round_step(own_column(touches, drive.removeprefix(OWN))) if is_own(drive) else 1.0


def step_inner(touches: Touches, drive: str, name: str = "step") -> Inner:
    """The step of an own column as an inner parameter: a single value, chosen and not found.

    It stays with the effect, so that the same model means the same on another run.
    """
    return Inner(name, "1", np.array([step_of(touches, drive)]), continuous=False)


def round_step(values: Array) -> float:
    """Power of ten next to the standard deviation of a column; 1 of a constant one.

    Example:
        >>> round_step(np.array([0.0, 30.0]))
        10.0
    """
    spread = float(np.std(values))
    return float(10.0 ** np.round(np.log10(spread))) if spread > 0.0 else 1.0


def lagged(touches: Touches, drive: Array, tau: float, steps: bool = False) -> Array:
    """`first_order_lag` of a drive (N,) recorded at the touches, for each run separately."""
    out = np.empty_like(drive)
    for i in range(len(touches.runs)):
        own = touches.run == i
        if own.any():
            out[own] = first_order_lag(touches.since_start[own], drive[own], tau, steps)
    return out


def first_order_lag(time: Array, drive: Array, tau: float, steps: bool = False) -> Array:
    """First-order lag of a record, exact between the records, (N,), in the unit of the drive.

    ``tau dy/dt = d - y``. With ``x = dt/tau`` and a straight drive from d0 to d1 one step is
    ``y1 = e^-x y0 + (1 - e^-x) d0 + (1 - (1 - e^-x)/x) (d1 - d0)``; with a constant one it ends
    before the last term, d0 being the drive that was set at the record before.

    Args:
        time: Times of the records, shape (N,), s, in any order.
        drive: Values, shape (N,).
        tau: Time constant, s.
        steps: Whether the drive is constant from one record to the next, and the body cold (y = 0)
            at time zero; otherwise straight, and y = d at the first record.
    """
    order = np.argsort(time, kind="stable")
    t, d = time[order], drive[order]
    if steps:
        d, t = np.concatenate([d[:1], d[:-1]]), np.concatenate([[min(0.0, float(t[0]))], t])
        keep = np.exp(-np.diff(t) / tau)
        added = (1.0 - keep) * d
    else:
        x = np.maximum(np.diff(t) / tau, 1e-12)
        gone = -np.expm1(-x)
        keep = np.concatenate([[0.0], 1.0 - gone])
        added = np.concatenate([d[:1], gone * d[:-1] + (1.0 - gone / x) * np.diff(d)])
    out = np.empty_like(drive)
    out[order] = _recursion(keep, added)
    return out


def _recursion(keep: Array, added: Array) -> Array:
    """y_i = keep_i y_(i-1) + added_i with y before the first zero, in log2(N) vector steps."""
    factor, y = keep.copy(), added.copy()
    stride = 1
    while stride < len(y):
        y[stride:] += factor[stride:] * y[:-stride].copy()
        factor[stride:] = factor[stride:] * factor[:-stride]
        stride *= 2
    return y
