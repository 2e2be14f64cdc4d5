"""What an effect is and how effects add up: columns of the linear model, the exact product.

An effect states where it acts (`Where`) and how much per unit of each parameter (`Term`); `Model`
adds terms up, to first order and exactly. `Declared` writes most of an effect from its fields,
`Kind` is a word of the library with its card, and `traits` answers what others ask of an effect.
"""

from matstd.twin.fields import moving_axes, refusal, sensors
from matstd.twin.machine import Where
from matstd.twin.model.declared import Amounts, Declared, scanned
from matstd.twin.model.effect import (
    Effect,
    Inner,
    Parameter,
    Saved,
    Term,
    Title,
    Tunable,
    contribution,
    inner_values,
    is_saved,
    is_tunable,
    own_title,
)
from matstd.twin.model.effect_traits import Traits, Wave, original_of, traits
from matstd.twin.model.kind import Kind
from matstd.twin.model.model import Model, columns

__all__ = [
    "Amounts", "Declared", "Effect", "Inner", "Kind", "Model", "Parameter", "Saved", "Term",
    "Title", "Traits", "Tunable", "Wave", "Where", "columns", "contribution", "inner_values",
    "is_saved", "is_tunable", "moving_axes", "original_of", "own_title", "refusal", "scanned",
    "sensors", "traits",
]  # fmt: skip
