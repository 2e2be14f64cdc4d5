"""What effects are called by those who run machines, with their names in brackets.

In: an `Effect`, a `Step`, a `Plan`, a name. Out: titles, and classes told as classes.
"""

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
