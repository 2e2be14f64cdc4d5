"""Any component error that follows a recorded drive at once: a sensor, or a column of one's own."""

from collections.abc import Iterable
from dataclasses import dataclass
from functools import cached_property
from typing import Annotated

import numpy as np

from matstd.twin.fields import (
    Argument,
    ComponentSymbol,
    Refuse,
    SensorName,
    changing_components,
    sensors,
)
from matstd.twin.frames import Array
from matstd.twin.machine import Chain, Symbol
from matstd.twin.model import Amounts, Declared, Effect, Kind, Title, scanned
from matstd.twin.record import Touches
from matstd.twin.thermal.drive_columns import CYCLE, OWN, PROGRESS, driven, drives, is_own, step_of
from matstd.twin.units import UM, URAD

USUAL_AMPLITUDE = (6 * UM, 20 * URAD)  # usual size of an error after a kelvin or a step, mm and rad


@dataclass(frozen=True)
class ThermalStatic(Declared):
    """A component error that follows a sensor at once, wherever the axis stands.

    ``E = a (T - 20 degC)``. Holds where the sensor sits on what expands, so that nothing lags. One
    parameter, the amplitude a, mm/K or rad/K: 1 to 30 um/K of a frame or a column.

    Reference:
        ISO 230-3 (environmental temperature variation); static thermal models.
    """

    symbol: ComponentSymbol
    sensor: SensorName

    kind, usual, per = "thermal-static", USUAL_AMPLITUDE, "/K"

    @cached_property
    def title(self) -> Title:
        """`growth along Z with frame`: which body grows is seldom seen."""
        what = "tilt" if self.symbol.is_angular else "growth"
        return Title(f"{what} {self.symbol.motion} with {self.sensor}", self.symbol.link)

    def amounts(self, touches: Touches) -> Amounts:
        return (driven(touches, self.sensor, 0.0, self.name),)


def _column(text: str, chain: Chain, refuse: Refuse) -> str:
    """With or without its `V_`."""
    return text.removeprefix(OWN)


def _steps(effect: "Follows", touches: Touches) -> Array:
    return np.array([step_of(touches, OWN + effect.column)])


@dataclass(frozen=True)
class Follows(Declared):
    """A component error that follows a column `V_name_unit` at once.

    ``E = a v / s``. The column is in a unit that only its user knows, so the amplitude a, mm or
    rad, is that of a step s, a round number near the spread of the column, which stays with the
    effect: the same model means the same on another run.
    """

    symbol: ComponentSymbol
    # name of the column without `V_`, its unit included
    column: Annotated[str, Argument("column of the user's own", _column)]
    # s, in the unit of the column
    step: float = scanned("1", _steps, default=1.0, continuous=False)

    kind, usual = "follows", USUAL_AMPLITUDE

    @property
    def driver(self) -> str:
        """What it follows."""
        return OWN + self.column

    @cached_property
    def title(self) -> Title:
        if self.column in (CYCLE, PROGRESS):
            how = "with every cycle" if self.column == CYCLE else "steadily over the cycles"
            return Title(f"{self.symbol.title} that grows {how}", self.symbol.link)
        column = self.column.removesuffix("_1").replace("_", " ")
        return Title(f"{self.symbol.title} that follows {column}", self.symbol.link)

    def amounts(self, touches: Touches) -> Amounts:
        return (driven(touches, OWN + self.column, 0.0, self.name, self.step),)


def follower(touches: Touches, symbol: Symbol, drive: str) -> Effect:
    """The component error that follows a drive, other than the spindle speed, at once."""
    if is_own(drive):
        return Follows(symbol, drive.removeprefix(OWN), step_of(touches, drive))
    return ThermalStatic(symbol, drive)


def _each(touches: Touches, names: Iterable[str]) -> Iterable[Effect]:
    """Every component of every axis that moved, after each of some drives."""
    for drive in names:
        for symbol in changing_components(touches):
            yield follower(touches, symbol, drive)


STATIC = Kind.of(
    ThermalStatic,
    title="thermal growth without a lag",
    synonyms="expansion of a frame, thermal displacement, temperature coefficient",
    formula="E = a (T - 20 degC), at once",
    units="a: µm/K or µrad/K",
    typical="frames and columns 1 to 30 µm/K",
    source="ISO 230-3",
    propose=lambda touches: _each(touches, sensors(touches)),
)

FOLLOWS = Kind.of(
    Follows,
    title="what follows a column of your own",
    synonyms="coolant, pressure, load, own sensor, own column",
    formula="E = a v / s, v a column V_name_unit, s a round step of it",
    units="a: µm or µrad a step; step: unit of the column",
    typical="whatever the column knows",
    source="the user",
    propose=lambda touches: _each(touches, filter(is_own, drives(touches))),
)
