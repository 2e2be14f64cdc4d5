"""Any component error as a first-order lag: after switching on, or after any recorded drive."""

from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import Annotated

import numpy as np

from matstd.twin.fields import Argument, ComponentSymbol, Refuse, changing_components
from matstd.twin.frames import Array
from matstd.twin.machine import Chain
from matstd.twin.model import Amounts, Declared, Kind, Parameter, Title, scanned
from matstd.twin.record import Touches
from matstd.twin.thermal.drive_columns import (
    SPINDLE,
    amplitude_unit,
    driven,
    drives,
    is_own,
    step_of,
)
from matstd.twin.units import MINUTE, UM, URAD

SHORTEST, LONGEST = 2.0 * MINUTE, 360.0 * MINUTE
"""Time constants that are scanned, s: a spindle nose 10 to 40 min, a column hours."""
STEPS = 14
"""Over the whole range neighbours differ by a factor of 1.5, between which the search refines."""


def _drive(text: str, chain: Chain, refuse: Refuse) -> str:
    if not text:
        raise refuse(f"a sensor, {SPINDLE} or an own column V_name_unit after the comma")
    return text


def _time_constants(effect: "ThermalLag", touches: Touches) -> Array:
    """Evenly spaced in the logarithm, up to three times the run."""
    duration = float(np.ptp(touches.since_start)) if len(touches) else LONGEST
    high = float(np.clip(3.0 * duration, 4.0 * SHORTEST, LONGEST))
    return np.geomspace(SHORTEST, high, STEPS)


@dataclass(frozen=True)
class ThermalLag(Declared):
    """A component error that follows its cause with a time constant.

    After switching on, at time zero, ``E = a (1 - exp(-t/tau))``. A body that follows a sensor or
    a column of the user's own is in equilibrium at the first record; one that follows the spindle
    speed is cold at time zero. The touches must be the whole run: a part of it has lost what drove
    it before.
    """

    symbol: ComponentSymbol
    # sensor, `spindle_rpm`, an own column `V_name_unit`, or "" for switching on
    drive: Annotated[str, Argument("sensor, spindle_rpm or V_column", _drive)] = ""
    tau: float = scanned("s", _time_constants, default=20.0 * MINUTE)  # time constant, s
    # step of the user's own column, in its unit; the amplitude is that after such a step
    step: float = scanned(
        "1",
        lambda self, touches: np.array([step_of(touches, self.drive)]),
        default=1.0,
        continuous=False,
    )

    kind, usual = "thermal-lag", (30 * UM, 100 * URAD)

    @property
    def driver(self) -> str:
        """What it follows; empty for switching on."""
        return self.drive

    @property
    def needs_history(self) -> bool:
        """Whether it follows a drive, which may have moved before the first touch."""
        return bool(self.drive)

    @cached_property
    def title(self) -> Title:
        """`growth along Z after switching on`: which body grows is seldom seen."""
        what = "tilt" if self.symbol.is_angular else "growth"
        cause = {"": "switching on", SPINDLE: "the spindle speed"}.get(self.drive, self.drive)
        return Title(f"{what} {self.symbol.motion} after {cause}", self.symbol.link)

    @cached_property
    def parameters(self) -> Sequence[Parameter]:
        whole = self.sized("amplitude")
        return (Parameter("amplitude", *amplitude_unit(self.drive, whole.unit, whole.sd)),)

    def amounts(self, touches: Touches) -> Amounts:
        return (self.response(touches),)

    def response(self, touches: Touches) -> Array:
        """Response to the drive at every touch, per unit of amplitude, (N,)."""
        if not self.drive:
            return -np.expm1(-touches.since_start / self.tau)
        return driven(touches, self.drive, self.tau, self.name, self.step)

    @property
    def searched(self) -> Sequence[str]:
        return ("tau", "step") if is_own(self.drive) else ("tau",)


def propose(touches: Touches) -> Iterable[ThermalLag]:
    """Every component of every axis that moved, with every drive that was recorded and varies."""
    if np.ptp(touches.since_start) > 0.0:
        for drive in ("", *drives(touches)):
            step = step_of(touches, drive)
            for symbol in changing_components(touches):
                yield ThermalLag(symbol, drive, step=step)


KIND = Kind.of(
    ThermalLag,
    title="spindle growth and other warming up",
    synonyms="spindle growth, warm-up, thermal drift, thermal displacement, time "
    "constant, thermal drift of the column, heating, lag after an own column",
    formula="tau dE/dt = a d - E; d = 1 from time zero, T - 20 degC, n/(10 000 rpm), "
    "or v/s of an own column",
    units="a: µm or µrad, per K after a sensor, a step s of an own column; tau: min",
    typical="spindle growth 20 to 100 µm, tau 10 to 40 min; ambient 1 to 5 µm/K, tau 0.5 to 6 h",
    source="ISO 230-3 (thermal distortion); J. S. Chen 1995; grey-box models of rotary axes",
    propose=propose,
)
