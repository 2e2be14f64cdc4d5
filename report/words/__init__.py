"""Sentences made from results, for pages and for the console; nothing parses them.

A module for each room below: what a result says in numbers and names is told here in words with
units, values with their uncertainty.
"""

from report.words.diagnosis_words import (
    comparison_sentence,
    microns,
    named_value,
    region_words,
    rivals_words,
    sizes,
    stated_noise,
    structure_words,
    values,
    verdict_sentence,
)
from report.words.probe_words import ordering_words
from report.words.remark_words import remark_sentence
from report.words.sensitivity_words import study_words, unsampled

__all__ = [
    "comparison_sentence",
    "microns",
    "named_value",
    "ordering_words",
    "region_words",
    "remark_sentence",
    "rivals_words",
    "sizes",
    "stated_noise",
    "structure_words",
    "study_words",
    "unsampled",
    "values",
    "verdict_sentence",
]
