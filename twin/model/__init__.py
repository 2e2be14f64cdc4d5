"""What an effect is and how effects add up: columns of the linear model, the exact product.

An effect says where it acts (`Where`) and how much per unit of each parameter (`Term`); `Model`
adds terms up, to first order and exactly. `Kind` is a word of the library with what users are told
of it.
"""

from matstd.twin.machine import Where
from matstd.twin.model.effect import (
    Acts,
    Effect,
    Inner,
    Parameter,
    Term,
    Title,
    Titled,
    Tunable,
    contribution,
    inner_values,
    is_tunable,
)
from matstd.twin.model.kind import (
    Kind,
    check_count,
    checked_axis,
    checked_linear,
    component_symbol,
    moved_components,
    moving_axes,
    refusal,
    sensor_record,
    sensors,
    varies,
)
from matstd.twin.model.model import Model, columns

__all__ = [
    "Acts",
    "Effect",
    "Inner",
    "Kind",
    "Model",
    "Parameter",
    "Term",
    "Title",
    "Titled",
    "Tunable",
    "Where",
    "check_count",
    "checked_axis",
    "checked_linear",
    "columns",
    "component_symbol",
    "contribution",
    "inner_values",
    "is_tunable",
    "moved_components",
    "moving_axes",
    "refusal",
    "sensor_record",
    "sensors",
    "varies",
]
