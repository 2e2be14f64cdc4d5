"""The three parts of a verdict in words, and what results mean for the use of a machine.

In: a `Diagnosis` or a `Comparison`, budgets, a study. Out: lines for the console and a section of
the page; the words of the box below its head.
"""

from matstd.report.verdict.meanings import (
    comparison_meaning,
    diagnosis_meaning,
    study_meaning,
    uncertainty_meaning,
)
from matstd.report.verdict.part_words import (
    part_lines,
    promise_sentence,
    promise_words,
    repeatability_words,
)

__all__ = [
    "comparison_meaning",
    "diagnosis_meaning",
    "part_lines",
    "promise_sentence",
    "promise_words",
    "repeatability_words",
    "study_meaning",
    "uncertainty_meaning",
]
