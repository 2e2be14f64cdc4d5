"""The three parts of a verdict in words, and what results mean for the use of a machine.

In: a `Diagnosis` or a `Comparison`, budgets, a study. Out: lines for the console and a section of
the page; the words of the box below its head.
"""

from matstd.report.verdict.meanings import comparison_meaning as comparison_meaning
from matstd.report.verdict.meanings import diagnosis_meaning as diagnosis_meaning
from matstd.report.verdict.meanings import study_meaning as study_meaning
from matstd.report.verdict.meanings import uncertainty_meaning as uncertainty_meaning
from matstd.report.verdict.part_words import part_lines as part_lines
from matstd.report.verdict.part_words import promise_sentence as promise_sentence
from matstd.report.verdict.part_words import promise_words as promise_words
from matstd.report.verdict.part_words import repeatability_words as repeatability_words
