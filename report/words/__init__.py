"""Sentences made from results, for pages and for the console; nothing parses them.

A module for each room below: what a result says in numbers and names is told here in words with
units, values with their uncertainty.
"""

from report.words.artefact_words import criterion_words, percent
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
from report.words.probe_words import ordering_words
from report.words.sensitivity_words import study_words, unsampled

__all__ = [
    "comparison_sentence",
    "criterion_words",
    "microns",
    "named_value",
    "ordering_words",
    "percent",
    "rivals_words",
    "sizes",
    "stated_noise",
    "study_words",
    "unsampled",
    "values",
    "verdict_sentence",
]
