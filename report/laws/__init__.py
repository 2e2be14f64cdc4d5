"""Laws that were learnt, in words, pictures, on a page, and as a Python file of the user's own."""

from matstd.report.laws.curves import LawCurve as LawCurve
from matstd.report.laws.curves import law_curve as law_curve
from matstd.report.laws.effect_file import effect_text as effect_text
from matstd.report.laws.law_page import law_sections as law_sections
from matstd.report.laws.law_page import write_law_page as write_law_page
from matstd.report.laws.law_words import held_out_sentence as held_out_sentence
from matstd.report.laws.law_words import instead_sentence as instead_sentence
from matstd.report.laws.law_words import law_notes as law_notes
from matstd.report.laws.law_words import law_sentence as law_sentence
from matstd.report.laws.law_words import learnt_words as learnt_words
from matstd.report.laws.law_words import limits_sentences as limits_sentences
from matstd.report.laws.law_words import no_law_sentence as no_law_sentence
from matstd.report.laws.law_words import rival_sentence as rival_sentence
from matstd.report.laws.law_words import short_words as short_words
from matstd.report.laws.law_words import size_words as size_words
from matstd.report.laws.run_words import second_run_sentence as second_run_sentence
from matstd.report.laws.visit_words import made_on_twin as made_on_twin
from matstd.report.laws.visit_words import visit_conditions as visit_conditions
from matstd.report.laws.visit_words import visit_sentences as visit_sentences
