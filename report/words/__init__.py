"""Sentences made from results, for pages and for the console; nothing parses them.

A module for each room below: what a result says in numbers and names is told here in words with
units, values with their uncertainty.
"""

from report.words.artefact_words import (
    comparison_remarks,
    criterion_words,
    identification_sentence,
)
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
from report.words.sensitivity_words import (
    dominant_words,
    place_words,
    sampling_words,
    study_words,
    unsampled,
)

__all__ = [
    "combination_words",
    "comparison_remarks",
    "comparison_sentence",
    "criterion_words",
    "dominant_words",
    "family_words",
    "gist",
    "identification_sentence",
    "in_words",
    "microns",
    "named_value",
    "ordering_words",
    "pair_words",
    "place_words",
    "reason_words",
    "region_words",
    "remark_sentence",
    "resolution_words",
    "rivals_words",
    "sampling_words",
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
