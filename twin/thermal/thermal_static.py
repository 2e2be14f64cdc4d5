"""Any component error that follows a sensor at once."""

from collections.abc import Iterable, Sequence
from dataclasses import dataclass

from twin.machine import Chain, Family, Symbol
from twin.model import (
    Kind,
    Parameter,
    Term,
    Title,
    Where,
    check_count,
    component_symbol,
    moving_axes,
    sensor_record,
    sensors,
)
from twin.record import Touches
from twin.units import T_REF, UM, URAD

USAGE = "thermal-static(symbol,sensor)"


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

    @property
    def parameters(self) -> Sequence[Parameter]:
        """The amplitude per kelvin."""
        sd = 20 * URAD if self.symbol.is_angular else 6 * UM
        return (Parameter("amplitude", f"{self.symbol.unit}/K", sd),)

    def terms(self, touches: Touches) -> Sequence[Term]:
        """A twist of the axis."""
        i = touches.chain.link_index(self.symbol.link)
        warmth = sensor_record(touches, self.sensor) - T_REF
        return (Term(0, Where("twist", i, self.symbol.component), warmth),)


def make(chain: Chain, arguments: Sequence[str]) -> ThermalStatic:
    """From the component error and the sensor."""
    check_count(USAGE, arguments, 2, 2)
    return ThermalStatic(component_symbol(chain, arguments[0]), arguments[1])


def propose(touches: Touches) -> Iterable[ThermalStatic]:
    """Every component of every axis that moved, with every sensor that varies.

    Where nothing moved the axis next to the tool stands for the machine.
    """
    axes = moving_axes(touches) or touches.chain.axes[-1:]
    for sensor in sensors(touches):
        for symbol in touches.chain.symbols:
            if symbol.family is Family.COMPONENT and symbol.link in axes:
                yield ThermalStatic(symbol, sensor)


KIND = Kind(
    word="thermal-static",
    arguments="symbol,sensor",
    title="thermal growth without a lag",
    synonyms="expansion of a frame, thermal displacement, temperature coefficient",
    formula="E = a (T - 20 degC), at once",
    units="a: µm/K or µrad/K",
    typical="frames and columns 1 to 30 µm/K",
    source="ISO 230-3",
    make=make,
    propose=propose,
    classes=(ThermalStatic,),
)
