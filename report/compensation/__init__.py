"""Compensation in words and pictures: errors before and after."""

from matstd.report.compensation.compensation_pictures import (
    draw_program,
    draw_shares_along,
    share_lines,
)
from matstd.report.compensation.compensation_words import (
    grown_sentence,
    program_lines,
    result_sentence,
    table_lines,
)
from matstd.report.compensation.table_page import write_compensation_page

__all__ = [
    "draw_program",
    "draw_shares_along",
    "grown_sentence",
    "program_lines",
    "result_sentence",
    "share_lines",
    "table_lines",
    "write_compensation_page",
]
