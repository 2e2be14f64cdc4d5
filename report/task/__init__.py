"""Calibration of a standard and uncertainty of a task, in words and rows of tables."""

from matstd.report.task.calibration_words import calibration_lines as calibration_lines
from matstd.report.task.calibration_words import modulus_words as modulus_words
from matstd.report.task.calibration_words import refusal_sentence as refusal_sentence
from matstd.report.task.calibration_words import verdict_lines as verdict_lines
from matstd.report.task.calibration_words import verdict_rows as verdict_rows
from matstd.report.task.making_words import FILES as FILES
from matstd.report.task.making_words import fewer_lines as fewer_lines
from matstd.report.task.making_words import making_lines as making_lines
from matstd.report.task.making_words import price_lines as price_lines
from matstd.report.task.task_words import FEW_VISITS as FEW_VISITS
from matstd.report.task.task_words import budget_rows as budget_rows
from matstd.report.task.task_words import measured_sentence as measured_sentence
from matstd.report.task.task_words import task_lines as task_lines
