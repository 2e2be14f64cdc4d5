"""Calibration of a standard and uncertainty of a task, in words and rows of tables."""

from matstd.report.task.calibration_words import (
    calibration_lines,
    modulus_words,
    refusal_sentence,
    verdict_lines,
    verdict_rows,
)
from matstd.report.task.making_words import fewer_lines, making_lines, price_lines
from matstd.report.task.task_words import FEW_VISITS, budget_rows, measured_sentence, task_lines

__all__ = [
    "FEW_VISITS",
    "budget_rows",
    "calibration_lines",
    "fewer_lines",
    "making_lines",
    "measured_sentence",
    "modulus_words",
    "price_lines",
    "refusal_sentence",
    "task_lines",
    "verdict_lines",
    "verdict_rows",
]
