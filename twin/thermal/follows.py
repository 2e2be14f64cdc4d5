"""Any component error that follows a recorded drive at once: a sensor, or a column of one's own."""

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cached_property

from matstd.twin.machine import Chain, Symbol
from matstd.twin.model import (
    Effect,
    Inner,
    Kind,
    Parameter,
    Term,
    Title,
    check_count,
    component_symbol,
    moved_components,
    sensors,
)
from matstd.twin.record import Touches
from matstd.twin.thermal.drive_columns import (
    CYCLE,
    OWN,
    PROGRESS,
    driven,
    drives,
    is_own,
    step_inner,
    step_of,
)
from matstd.twin.units import UM, URAD


@dataclass(frozen=True)
class ThermalStatic:
    """A component error that follows a sensor at once, wherever the axis stands.

    ``E = a (T - 20 degC)``. Holds where the sensor sits on what expands, so that nothing lags. One
    parameter, the amplitude a, mm/K or rad/K: 1 to 30 um/K of a frame or a column.

    Attributes:
        sensor: Name of the sensor.

    Reference:
        ISO 230-3 (environmental temperature variation); static thermal models.
    """

    symbol: Symbol
    sensor: str

    kind = "thermal-static"

    @property
    def name(self) -> str:
        """`thermal-static(EZZ,frame)`."""
        return f"thermal-static({self.symbol.name},{self.sensor})"

    @property
    def title(self) -> Title:
        """In the words of those who run machines."""
        what = "tilt" if self.symbol.is_angular else "growth"
        return Title(f"{what} {self.symbol.motion} with {self.sensor}", self.symbol.link)

    @cached_property
    def parameters(self) -> Sequence[Parameter]:
        """The amplitude per kelvin."""
        return (Parameter("amplitude", f"{self.symbol.unit}/K", _usual(self.symbol)),)

    def terms(self, touches: Touches) -> Sequence[Term]:
        """A twist of the axis."""
        warmth = driven(touches, self.sensor, 0.0, self.name)
        return (Term(0, touches.chain.twist_of(self.symbol), warmth),)


@dataclass(frozen=True)
class Follows:
    """A component error that follows a column `V_name_unit` at once.

    ``E = a v / s``. The column is in a unit that only its user knows, so the amplitude a, mm or
    rad, is that of a step s, a round number near the spread of the column, which stays with the
    effect: the same model means the same on another run.

    Attributes:
        column: Name of the column without `V_`, its unit included.
        step: s, in the unit of the column.
    """

    symbol: Symbol
    column: str
    step: float = 1.0

    kind = "follows"

    @property
    def name(self) -> str:
        """`follows(EZZ,coolant_l_min)`."""
        return f"follows({self.symbol.name},{self.column})"

    @property
    def title(self) -> Title:
        """In the words of those who run machines."""
        if self.column in (CYCLE, PROGRESS):
            how = "with every cycle" if self.column == CYCLE else "steadily over the cycles"
            return Title(f"{self.symbol.title} that grows {how}", self.symbol.link)
        column = self.column.removesuffix("_1").replace("_", " ")
        return Title(f"{self.symbol.title} that follows {column}", self.symbol.link)

    @cached_property
    def parameters(self) -> Sequence[Parameter]:
        """The amplitude of a step."""
        return (Parameter("amplitude", self.symbol.unit, _usual(self.symbol)),)

    def terms(self, touches: Touches) -> Sequence[Term]:
        """A twist of the axis."""
        amount = driven(touches, OWN + self.column, 0.0, self.name, self.step)
        return (Term(0, touches.chain.twist_of(self.symbol), amount),)

    def inner(self, touches: Touches) -> Sequence[Inner]:
        """The step."""
        return (step_inner(touches, OWN + self.column),)

    def tuned(self, *values: float) -> "Follows":
        """With this step."""
        return replace(self, step=float(values[0]))

    @property
    def tuning(self) -> Mapping[str, float]:
        """The step."""
        return {"step": self.step}


def _usual(symbol: Symbol) -> float:
    """Usual size of an error after a kelvin or a step, mm or rad."""
    return 20 * URAD if symbol.is_angular else 6 * UM


def follower(touches: Touches, symbol: Symbol, drive: str) -> Effect:
    """The component error that follows a drive, other than the spindle speed, at once."""
    if is_own(drive):
        return Follows(symbol, drive.removeprefix(OWN), step_of(touches, drive))
    return ThermalStatic(symbol, drive)


def _make_static(chain: Chain, arguments: Sequence[str]) -> ThermalStatic:
    """From the component error and the sensor."""
    check_count(STATIC.usage, arguments, 2, 2)
    return ThermalStatic(component_symbol(chain, arguments[0]), arguments[1])


def _make_own(chain: Chain, arguments: Sequence[str]) -> Follows:
    """From the component error and the column, with or without its `V_`."""
    check_count(FOLLOWS.usage, arguments, 2, 2)
    return Follows(component_symbol(chain, arguments[0]), arguments[1].removeprefix(OWN))


def _each(touches: Touches, names: Iterable[str]) -> Iterable[Effect]:
    """Every component of every axis that moved, after each of some drives."""
    for drive in names:
        for symbol in moved_components(touches):
            yield follower(touches, symbol, drive)


STATIC = Kind(
    word="thermal-static",
    arguments="symbol,sensor",
    title="thermal growth without a lag",
    synonyms="expansion of a frame, thermal displacement, temperature coefficient",
    formula="E = a (T - 20 degC), at once",
    units="a: µm/K or µrad/K",
    typical="frames and columns 1 to 30 µm/K",
    source="ISO 230-3",
    make=_make_static,
    propose=lambda touches: _each(touches, sensors(touches)),
    classes=(ThermalStatic,),
)

FOLLOWS = Kind(
    word="follows",
    arguments="symbol,column of the user's own",
    title="what follows a column of your own",
    synonyms="coolant, pressure, load, own sensor, own column",
    formula="E = a v / s, v a column V_name_unit, s a round step of it",
    units="a: µm or µrad a step; step: unit of the column",
    typical="whatever the column knows",
    source="the user",
    make=_make_own,
    propose=lambda touches: _each(touches, filter(is_own, drives(touches))),
    classes=(Follows,),
)
