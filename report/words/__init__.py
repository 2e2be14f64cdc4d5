"""Sentences made from results."""

from report.words.artefact_words import criterion_words
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

__all__ = [
    "comparison_sentence",
    "criterion_words",
    "microns",
    "named_value",
    "ordering_words",
    "rivals_words",
    "sizes",
    "stated_noise",
    "values",
    "verdict_sentence",
]
