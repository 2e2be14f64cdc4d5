"""Compensation in words and pictures: errors before and after."""

from matstd.report.compensation.compensation_pictures import draw_program as draw_program
from matstd.report.compensation.compensation_pictures import draw_shares_along as draw_shares_along
from matstd.report.compensation.compensation_pictures import share_lines as share_lines
from matstd.report.compensation.compensation_words import grown_sentence as grown_sentence
from matstd.report.compensation.compensation_words import program_lines as program_lines
from matstd.report.compensation.compensation_words import result_sentence as result_sentence
from matstd.report.compensation.compensation_words import table_lines as table_lines
from matstd.report.compensation.table_page import write_compensation_page as write_compensation_page
