"""Sentences made from results."""

from report.words.diagnosis_words import (
    comparison_sentence,
    microns,
    named_value,
    rivals_words,
    sizes,
    stated_noise,
    values,
    verdict_sentence,
)
from report.words.study_words import study_words, unsampled

__all__ = [
    "comparison_sentence",
    "microns",
    "named_value",
    "rivals_words",
    "sizes",
    "stated_noise",
    "study_words",
    "unsampled",
    "values",
    "verdict_sentence",
]
