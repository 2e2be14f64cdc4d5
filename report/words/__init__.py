"""Sentences made from results."""

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
    "values",
    "verdict_sentence",
]
