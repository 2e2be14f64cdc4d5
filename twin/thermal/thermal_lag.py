"""Any component error as a first-order lag: after switching on, after a sensor, after the spindle.

A body that is heated settles with its own time constant. What drives it is recorded at the touches
only, so the equation is integrated exactly for a drive that is straight between two records (or
constant, for the spindle speed), over whatever times the touches were made at.
"""

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np

from twin.errors import UnknownEffect
from twin.frames import Array
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
    refusal,
    sensor_record,
    sensors,
    varies,
)
from twin.record import Touches
from twin.units import MINUTE, T_REF, UM, URAD

SPINDLE = "spindle_rpm"
"""The drive that is no sensor: the spindle speed of the run file."""
SPEED_UNIT = 1.0e4
"""Amplitudes after the spindle speed are those at 10 000 rpm, 1/min."""

SHORTEST, LONGEST = 2.0 * MINUTE, 360.0 * MINUTE
"""Time constants that are scanned, s: a spindle nose 10 to 40 min, a column hours."""
STEPS = 14
"""Over the whole range neighbours differ by a factor of 1.5, between which the search refines."""


@dataclass(frozen=True)
class ThermalLag:
    """A component error that follows its cause with a time constant.

    After switching on, at time zero, ``E = a (1 - exp(-t/tau))``. A body that follows a sensor is
    in equilibrium at the first record; one that follows the spindle speed is cold at time zero. The
    touches must be the whole run: a part of it has lost what drove it before.

    Attributes:
        drive: Sensor, `spindle_rpm`, or "" for switching on.
        tau: Time constant, s.
    """

    symbol: Symbol
    drive: str = ""
    tau: float = 20.0 * MINUTE

    kind = "thermal-lag"

    @property
    def name(self) -> str:
        """`thermal-lag(EZZ)`, `thermal-lag(EZZ,spindle_rpm)`."""
        return f"thermal-lag({self.symbol.name}{',' if self.drive else ''}{self.drive})"

    @property
    def title(self) -> Title:
        """`growth along Z after switching on`: which body grows is seldom seen."""
        what = "tilt" if self.symbol.is_angular else "growth"
        cause = {"": "switching on", SPINDLE: "the spindle speed"}.get(self.drive, self.drive)
        return Title(f"{what} {self.symbol.motion} after {cause}", self.symbol.link)

    @property
    def parameters(self) -> Sequence[Parameter]:
        """The settled amplitude."""
        unit, sd = self.symbol.unit, 100 * URAD if self.symbol.is_angular else 30 * UM
        if self.drive not in ("", SPINDLE):
            return (Parameter("amplitude", f"{unit}/K", 0.2 * sd),)
        return (Parameter("amplitude", unit, sd),)

    def terms(self, touches: Touches) -> Sequence[Term]:
        """A twist of the axis."""
        i = touches.chain.link_index(self.symbol.link)
        return (Term(0, Where("twist", i, self.symbol.component), self.response(touches)),)

    def response(self, touches: Touches) -> Array:
        """What has followed of the drive at every touch, per unit of amplitude, (N,)."""
        if not self.drive:
            return -np.expm1(-touches.since_start / self.tau)
        if self.drive == SPINDLE:
            if touches.spindle_rpm is None:
                raise UnknownEffect(f"'{self.name}': the spindle speed of these touches is unknown")
            return lagged(touches, touches.spindle_rpm / SPEED_UNIT, self.tau, steps=True)
        return lagged(touches, sensor_record(touches, self.drive) - T_REF, self.tau)

    def inner(self, touches: Touches) -> Sequence[Inner]:
        """The time constant, evenly spaced in its logarithm, up to three times the run."""
        duration = float(np.ptp(touches.since_start)) if len(touches) else LONGEST
        high = float(np.clip(3.0 * duration, 4.0 * SHORTEST, LONGEST))
        return (Inner("tau", "s", np.geomspace(SHORTEST, high, STEPS)),)

    def tuned(self, *values: float) -> "ThermalLag":
        """With this time constant, s."""
        return replace(self, tau=float(values[0]))

    @property
    def tuning(self) -> Mapping[str, float]:
        """The time constant, s."""
        return {"tau": self.tau}


def lagged(touches: Touches, drive: Array, tau: float, steps: bool = False) -> Array:
    """`first_order_lag` of a drive (N,) that was recorded at the touches, in every run anew."""
    out = np.empty_like(drive)
    for i in range(len(touches.runs)):
        own = touches.run == i
        if own.any():
            out[own] = first_order_lag(touches.since_start[own], drive[own], tau, steps)
    return out


def first_order_lag(time: Array, drive: Array, tau: float, steps: bool = False) -> Array:
    """First-order lag of a record, exact between the records.

    ``tau dy/dt = d - y``. With ``x = dt/tau`` and a straight drive from d0 to d1 one step is
    ``y1 = e^-x y0 + (1 - e^-x) d0 + (1 - (1 - e^-x)/x) (d1 - d0)``; with a constant one it ends
    before the last term, d0 being the drive that was set at the record before.

    Args:
        time: Of the records, shape (N,), s, in any order.
        drive: Values, shape (N,).
        tau: Time constant, s.
        steps: Whether the drive is constant from one record to the next, and the body cold (y = 0)
            at time zero; otherwise straight, and y = d at the first record.

    Returns:
        Shape (N,), in the unit of the drive.
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


def make(chain: Chain, arguments: Sequence[str]) -> ThermalLag:
    """From the component error and, where something drives it, a sensor or `spindle_rpm`."""
    check_count(KIND.usage, arguments, 1, 2)
    symbol = component_symbol(chain, arguments[0])
    if len(arguments) == 2 and not arguments[1]:
        raise refusal(KIND.usage, arguments, f"a sensor or {SPINDLE} after the comma")
    return ThermalLag(symbol, arguments[1] if len(arguments) == 2 else "")


def propose(touches: Touches) -> Iterable[ThermalLag]:
    """Every component of every axis that moved, with every drive that was recorded and varies.

    Where nothing moved, as in front of a nest of displacement probes, the axis next to the tool
    stands for the machine.
    """
    drives = ["", *sensors(touches)]
    if touches.spindle_rpm is not None and varies(touches.spindle_rpm):
        drives.append(SPINDLE)
    if not np.ptp(touches.time) > 0.0:
        return
    axes = moving_axes(touches) or touches.chain.axes[-1:]
    for drive in drives:
        for symbol in touches.chain.symbols:
            if symbol.family is Family.COMPONENT and symbol.link in axes:
                yield ThermalLag(symbol, drive)


KIND = Kind(
    word="thermal-lag",
    arguments="symbol[,sensor or spindle_rpm]",
    title="spindle growth and other warming up",
    synonyms="spindle growth, warm-up, thermal drift, thermal displacement, time "
    "constant, thermal drift of the column, heating",
    formula="tau dE/dt = a d - E; d = 1 from time zero, T - 20 degC, or n/(10 000 rpm)",
    units="a: µm or µrad, per K after a sensor; tau: min",
    typical="spindle growth 20 to 100 µm, tau 10 to 40 min; ambient 1 to 5 µm/K, tau 0.5 to 6 h",
    source="ISO 230-3 (thermal distortion); J. S. Chen 1995; grey-box models of rotary axes",
    make=make,
    propose=propose,
    classes=(ThermalLag,),
)
