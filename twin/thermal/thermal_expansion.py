"""Expansion of a scale or screw with a temperature."""

from dataclasses import dataclass

from matstd.twin.fields import LinearAxisName, SensorName, sensor_record
from matstd.twin.model import Amounts, Declared, Kind, Parameter
from matstd.twin.record import Touches
from matstd.twin.units import T_REF


@dataclass(frozen=True)
class ThermalExpansion(Declared):
    """The scale of a linear axis grows with the temperature of a sensor.

    Holds for a scale that is fixed at reading zero, free elsewhere, and has one temperature over
    its whole length. A screw that is warmer than its sensor shows a larger alpha.
    """

    axis: LinearAxisName
    sensor: SensorName

    kind, called = "thermal-expansion", "expansion of the scale of {axis} with {sensor}"
    parameters = (Parameter("amplitude", "1/K", 20e-6),)

    def amounts(self, touches: Touches) -> Amounts:
        return ((sensor_record(touches, self.sensor) - T_REF) * touches.reading(self.axis),)


KIND = Kind.of(
    ThermalExpansion,
    title="thermal growth of a scale or screw",
    synonyms="scale growth, expansion of an axis, ball screw heating, glass scale, "
    "temperature coefficient",
    formula="E = alpha (T - 20 degC) q, along the axis",
    units="alpha: µm/(m K)",
    typical="steel 10 to 12, glass 8, aluminium 23 µm/(m K)",
    source="ISO 1 (20 degC); ISO 230-3 (thermal effects)",
)
