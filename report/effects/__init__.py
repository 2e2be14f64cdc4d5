"""Titles of effects, and of the classes of effects that a run cannot distinguish."""

from matstd.report.effects.naming import (
    class_words,
    effect_cell,
    effect_title,
    effect_words,
    plan_words,
    rival_words,
    words_of_name,
)

__all__ = [
    "class_words",
    "effect_cell",
    "effect_title",
    "effect_words",
    "plan_words",
    "rival_words",
    "words_of_name",
]
