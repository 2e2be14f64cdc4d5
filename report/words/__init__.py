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
    unit_words,
    values,
    verdict_sentence,
)
from report.words.fault_words import fault_sentences
from report.words.geometry_words import (
    correction_line,
    geometry_lines,
    ladder_sentence,
    noted_lines,
)
from report.words.identifiability_file import write_identifiability
from report.words.identifiability_words import (
    combination_words,
    family_words,
    gist,
    pair_words,
    reason_words,
    resolution_words,
)
from report.words.identification_file import write_identification
from report.words.parameter_words import in_words, short
from report.words.probe_words import ordering_words
from report.words.remark_words import remark_sentence
from report.words.sensitivity_words import study_words, unsampled

__all__ = [
    "combination_words",
    "comparison_sentence",
    "correction_line",
    "family_words",
    "fault_sentences",
    "geometry_lines",
    "gist",
    "in_words",
    "ladder_sentence",
    "microns",
    "named_value",
    "noted_lines",
    "ordering_words",
    "pair_words",
    "reason_words",
    "region_words",
    "remark_sentence",
    "resolution_words",
    "rivals_words",
    "short",
    "sizes",
    "stated_noise",
    "structure_words",
    "study_words",
    "unit_words",
    "unsampled",
    "values",
    "verdict_sentence",
    "write_identifiability",
    "write_identification",
]
