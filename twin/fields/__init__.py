"""Fields of effects: the types by which a kind states once what stands in its brackets.

Below the effects themselves: axes, component errors and sensors by name, and which of them some
touches offer.
"""

from matstd.twin.fields.arguments import (
    AnySymbol,
    Argument,
    AxisName,
    ComponentSymbol,
    LinearAxisName,
    Refuse,
    SensorName,
    check_count,
    component_symbol,
    components_of,
    moved_components,
    moving_axes,
    moving_linear_axes,
    no_values,
    read_axis,
    read_linear_axis,
    read_text,
    refusal,
    sensor_record,
    sensors,
    varies,
)

__all__ = [
    "AnySymbol",
    "Argument",
    "AxisName",
    "ComponentSymbol",
    "LinearAxisName",
    "Refuse",
    "SensorName",
    "check_count",
    "component_symbol",
    "components_of",
    "moved_components",
    "moving_axes",
    "moving_linear_axes",
    "no_values",
    "read_axis",
    "read_linear_axis",
    "read_text",
    "refusal",
    "sensor_record",
    "sensors",
    "varies",
]
