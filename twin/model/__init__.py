"""What an effect is and how effects add up: columns of the linear model, the exact product."""

from twin.model.effect import Effect, Inner, Parameter, Term, Tunable, Where, contribution
from twin.model.kind import (
    Kind,
    base_unit,
    checked_axis,
    checked_linear,
    component_symbol,
    counted,
    moving_axes,
    own_component,
    refusal,
    sensor_record,
    sensors,
    varies,
)
from twin.model.model import Model, columns

__all__ = [
    "Effect",
    "Inner",
    "Kind",
    "Model",
    "Parameter",
    "Term",
    "Tunable",
    "Where",
    "base_unit",
    "checked_axis",
    "checked_linear",
    "columns",
    "component_symbol",
    "contribution",
    "counted",
    "moving_axes",
    "own_component",
    "refusal",
    "sensor_record",
    "sensors",
    "varies",
]
