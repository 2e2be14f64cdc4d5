"""A scale that follows the temperature of a sensor."""

from collections.abc import Iterable, Sequence
from dataclasses import dataclass

from matstd.twin.machine import Chain
from matstd.twin.model import (
    Kind,
    Parameter,
    Term,
    Title,
    Where,
    check_count,
    checked_linear,
    moving_axes,
    sensor_record,
    sensors,
)
from matstd.twin.record import Touches
from matstd.twin.units import T_REF


@dataclass(frozen=True)
class ThermalExpansion:
    """The scale of a linear axis grows with the temperature of a sensor.

    Holds for a scale that is fixed at reading zero, free elsewhere, and has one temperature over
    its whole length. A screw that is warmer than its sensor shows a larger alpha.

    Attributes:
        axis: Name of the linear axis.
        sensor: Name of the sensor.
        component: Index of the component along the axis.
    """

    axis: str
    sensor: str
    component: int

    kind = "thermal-expansion"

    @property
    def name(self) -> str:
        """`thermal-expansion(X,scaleX)`."""
        return f"thermal-expansion({self.axis},{self.sensor})"

    @property
    def title(self) -> Title:
        """In the words of those who run machines."""
        return Title(f"expansion of the scale of {self.axis} with {self.sensor}", self.axis)

    @property
    def parameters(self) -> Sequence[Parameter]:
        """Coefficient of expansion."""
        return (Parameter("amplitude", "1/K", 20e-6),)

    def terms(self, touches: Touches) -> Sequence[Term]:
        """A twist of the axis."""
        where = Where("twist", touches.chain.link_index(self.axis), self.component)
        warmth = sensor_record(touches, self.sensor) - T_REF
        return (Term(0, where, warmth * touches.reading(self.axis)),)


def make(chain: Chain, arguments: Sequence[str]) -> ThermalExpansion:
    """From the linear axis and the sensor."""
    check_count(KIND.usage, arguments, 2, 2)
    axis = checked_linear(KIND.usage, arguments, arguments[0], chain)
    return ThermalExpansion(axis, arguments[1], chain.link(axis).own_component)


def propose(touches: Touches) -> Iterable[ThermalExpansion]:
    """Every linear axis that moved with every sensor that varies."""
    for axis in moving_axes(touches):
        if axis in touches.chain.linear_axes:
            for sensor in sensors(touches):
                yield ThermalExpansion(axis, sensor, touches.chain.link(axis).own_component)


KIND = Kind(
    word="thermal-expansion",
    arguments="axis,sensor",
    title="thermal growth of a scale or screw",
    synonyms="scale growth, expansion of an axis, ball screw heating, glass scale, "
    "temperature coefficient",
    formula="E = alpha (T - 20 degC) q, along the axis",
    units="alpha: µm/(m K)",
    typical="steel 10 to 12, glass 8, aluminium 23 µm/(m K)",
    source="ISO 1 (20 degC); ISO 230-3 (thermal effects)",
    make=make,
    propose=propose,
    classes=(ThermalExpansion,),
)
