"""Sentences made from results, for pages and for the console; nothing parses them."""

from matstd.report.words.design_words import best_rival as best_rival
from matstd.report.words.design_words import comparison_remarks as comparison_remarks
from matstd.report.words.design_words import design_lines as design_lines
from matstd.report.words.design_words import identification_lines as identification_lines
from matstd.report.words.design_words import proof_line as proof_line
from matstd.report.words.design_words import verdict_of_design as verdict_of_design
from matstd.report.words.diagnosis_words import comparison_sentence as comparison_sentence
from matstd.report.words.diagnosis_words import figures as figures
from matstd.report.words.diagnosis_words import learnt_lines as learnt_lines
from matstd.report.words.diagnosis_words import region_sentence as region_sentence
from matstd.report.words.diagnosis_words import scanned_sentence as scanned_sentence
from matstd.report.words.diagnosis_words import sizes as sizes
from matstd.report.words.diagnosis_words import stated_noise as stated_noise
from matstd.report.words.diagnosis_words import structure_words as structure_words
from matstd.report.words.diagnosis_words import values as values
from matstd.report.words.family_words import features_words as features_words
from matstd.report.words.family_words import shown_line as shown_line
from matstd.report.words.probe_words import ball_lines as ball_lines
from matstd.report.words.probe_words import located_lines as located_lines
from matstd.report.words.remark_words import remark_sentence as remark_sentence
from matstd.report.words.sensitivity_words import dominant_words as dominant_words
from matstd.report.words.sensitivity_words import place_words as place_words
from matstd.report.words.sensitivity_words import sampling_words as sampling_words
from matstd.report.words.sensitivity_words import study_words as study_words
from matstd.report.words.sensitivity_words import unsampled as unsampled
from matstd.report.words.verdict_words import verdict_sentence as verdict_sentence
