"""Compensation in words and pictures: errors before and after."""

from matstd.report.compensation.program_picture import draw_program
from matstd.report.compensation.program_words import program_lines
from matstd.report.compensation.shares_picture import draw_shares_along, share_lines
from matstd.report.compensation.table_page import write_compensation_page
from matstd.report.compensation.table_words import result_sentence, table_lines

__all__ = [
    "draw_program",
    "draw_shares_along",
    "program_lines",
    "result_sentence",
    "share_lines",
    "table_lines",
    "write_compensation_page",
]
