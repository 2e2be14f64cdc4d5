"""Any component error as a first-order lag: after switching on, or after any recorded drive."""

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np

from matstd.twin.frames import Array
from matstd.twin.machine import Chain, Symbol
from matstd.twin.model import (
    Inner,
    Kind,
    Parameter,
    Term,
    Title,
    check_count,
    component_symbol,
    moved_components,
    refusal,
)
from matstd.twin.record import Touches
from matstd.twin.thermal.drive_columns import (
    SPINDLE,
    amplitude_unit,
    driven,
    drives,
    is_own,
    step_inner,
    step_of,
)
from matstd.twin.units import MINUTE, UM, URAD

SHORTEST, LONGEST = 2.0 * MINUTE, 360.0 * MINUTE
"""Time constants that are scanned, s: a spindle nose 10 to 40 min, a column hours."""
STEPS = 14
"""Over the whole range neighbours differ by a factor of 1.5, between which the search refines."""


@dataclass(frozen=True)
class ThermalLag:
    """A component error that follows its cause with a time constant.

    After switching on, at time zero, ``E = a (1 - exp(-t/tau))``. A body that follows a sensor or
    a column of the user's own is in equilibrium at the first record; one that follows the spindle
    speed is cold at time zero. The touches must be the whole run: a part of it has lost what drove
    it before.

    Attributes:
        drive: Sensor, `spindle_rpm`, an own column `V_name_unit`, or "" for switching on.
        tau: Time constant, s.
        step: Of an own column, in its unit; the amplitude is that after such a step.
    """

    symbol: Symbol
    drive: str = ""
    tau: float = 20.0 * MINUTE
    step: float = 1.0

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

    @cached_property
    def parameters(self) -> Sequence[Parameter]:
        """The settled amplitude."""
        unit, sd = self.symbol.unit, 100 * URAD if self.symbol.is_angular else 30 * UM
        return (Parameter("amplitude", *amplitude_unit(self.drive, unit, sd)),)

    def terms(self, touches: Touches) -> Sequence[Term]:
        """A twist of the axis."""
        return (Term(0, touches.chain.twist_of(self.symbol), self.response(touches)),)

    def response(self, touches: Touches) -> Array:
        """What has followed of the drive at every touch, per unit of amplitude, (N,)."""
        if not self.drive:
            return -np.expm1(-touches.since_start / self.tau)
        return driven(touches, self.drive, self.tau, self.name, self.step)

    def inner(self, touches: Touches) -> Sequence[Inner]:
        """The time constant, evenly spaced in its logarithm, up to three times the run; the step
        of an own column.
        """  # noqa: D205
        duration = float(np.ptp(touches.since_start)) if len(touches) else LONGEST
        high = float(np.clip(3.0 * duration, 4.0 * SHORTEST, LONGEST))
        tau = Inner("tau", "s", np.geomspace(SHORTEST, high, STEPS))
        return (tau, step_inner(touches, self.drive)) if is_own(self.drive) else (tau,)

    def tuned(self, *values: float) -> "ThermalLag":
        """With this time constant, s, and this step of an own column."""
        tau, step = (*map(float, values), self.step)[:2]
        return replace(self, tau=tau, step=step)

    @property
    def tuning(self) -> Mapping[str, float]:
        """The time constant, s, and the step of an own column."""
        step = {"step": self.step} if is_own(self.drive) else {}
        return {"tau": self.tau, **step}


def make(chain: Chain, arguments: Sequence[str]) -> ThermalLag:
    """From the component error and, where something drives it, the name of the drive."""
    check_count(KIND.usage, arguments, 1, 2)
    symbol = component_symbol(chain, arguments[0])
    if len(arguments) == 2 and not arguments[1]:
        raise refusal(
            KIND.usage,
            arguments,
            f"a sensor, {SPINDLE} or an own column V_name_unit after the comma",
        )
    return ThermalLag(symbol, arguments[1] if len(arguments) == 2 else "")


def propose(touches: Touches) -> Iterable[ThermalLag]:
    """Every component of every axis that moved, with every drive that was recorded and varies."""
    if np.ptp(touches.since_start) > 0.0:
        for drive in ("", *drives(touches)):
            step = step_of(touches, drive)
            for symbol in moved_components(touches):
                yield ThermalLag(symbol, drive, step=step)


KIND = Kind(
    word="thermal-lag",
    arguments="symbol[,sensor, spindle_rpm or V_column]",
    title="spindle growth and other warming up",
    synonyms="spindle growth, warm-up, thermal drift, thermal displacement, time "
    "constant, thermal drift of the column, heating, lag after an own column",
    formula="tau dE/dt = a d - E; d = 1 from time zero, T - 20 degC, n/(10 000 rpm), "
    "or v/s of an own column",
    units="a: µm or µrad, per K after a sensor, a step s of an own column; tau: min",
    typical="spindle growth 20 to 100 µm, tau 10 to 40 min; ambient 1 to 5 µm/K, tau 0.5 to 6 h",
    source="ISO 230-3 (thermal distortion); J. S. Chen 1995; grey-box models of rotary axes",
    make=make,
    propose=propose,
    classes=(ThermalLag,),
)
