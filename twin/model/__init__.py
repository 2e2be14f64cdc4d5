"""What an effect is and how effects add up: columns of the linear model, the exact product."""

from twin.machine import Where
from twin.model.effect import (
    Acts,
    Effect,
    Inner,
    Parameter,
    Term,
    Tunable,
    contribution,
    inner_values,
)
from twin.model.kind import (
    Kind,
    checked_axis,
    checked_linear,
    component_symbol,
    counted,
    moving_axes,
    refusal,
    sensor_record,
    sensors,
    varies,
)
from twin.model.model import Model, columns

__all__ = [
    "Acts",
    "Effect",
    "Inner",
    "Kind",
    "Model",
    "Parameter",
    "Term",
    "Tunable",
    "Where",
    "checked_axis",
    "checked_linear",
    "columns",
    "component_symbol",
    "contribution",
    "counted",
    "inner_values",
    "moving_axes",
    "refusal",
    "sensor_record",
    "sensors",
    "varies",
]
