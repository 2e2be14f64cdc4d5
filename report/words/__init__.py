"""Sentences made from results, for pages and for the console; nothing parses them."""

from matstd.report.words.design_words import (
    best_rival,
    comparison_remarks,
    design_lines,
    identification_lines,
    proof_line,
    verdict_of_design,
)
from matstd.report.words.diagnosis_words import (
    comparison_sentence,
    figures,
    learnt_lines,
    region_sentence,
    scanned_sentence,
    sizes,
    stated_noise,
    structure_words,
    values,
)
from matstd.report.words.family_words import features_words, shown_line
from matstd.report.words.probe_words import ball_lines, located_lines
from matstd.report.words.remark_words import remark_sentence
from matstd.report.words.sensitivity_words import (
    dominant_words,
    place_words,
    sampling_words,
    study_words,
    unsampled,
)
from matstd.report.words.verdict_words import verdict_sentence

__all__ = [
    "ball_lines",
    "best_rival",
    "comparison_remarks",
    "comparison_sentence",
    "design_lines",
    "dominant_words",
    "features_words",
    "figures",
    "identification_lines",
    "learnt_lines",
    "located_lines",
    "place_words",
    "proof_line",
    "region_sentence",
    "remark_sentence",
    "sampling_words",
    "scanned_sentence",
    "shown_line",
    "sizes",
    "stated_noise",
    "structure_words",
    "study_words",
    "unsampled",
    "values",
    "verdict_of_design",
    "verdict_sentence",
]
