"""Laws that were learnt, in words, pictures, on a page, and as a Python file of the user's own."""

from matstd.report.laws.curves import LawCurve, law_curve
from matstd.report.laws.effect_file import effect_text
from matstd.report.laws.law_page import law_sections, write_law_page
from matstd.report.laws.law_words import (
    held_out_sentence,
    instead_sentence,
    law_notes,
    law_sentence,
    learnt_words,
    limits_sentences,
    no_law_sentence,
    rival_sentence,
    short_words,
    size_words,
)
from matstd.report.laws.run_words import second_run_sentence
from matstd.report.laws.visit_words import visit_lines, visit_sentences

__all__ = [
    "LawCurve",
    "effect_text",
    "held_out_sentence",
    "instead_sentence",
    "law_curve",
    "law_notes",
    "law_sections",
    "law_sentence",
    "learnt_words",
    "limits_sentences",
    "no_law_sentence",
    "rival_sentence",
    "second_run_sentence",
    "short_words",
    "size_words",
    "visit_lines",
    "visit_sentences",
    "write_law_page",
]
