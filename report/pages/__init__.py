"""HTML pages, each in one file that loads nothing from anywhere; notebook displays of results.

A page is a list of `Section`s (sentences, table, pictures) under a verdict and key figures;
`write_page` renders every page in the same way and writes its tables as CSV and workbook.
"""

from matstd.report.layout import (
    Printer,
    printer,
    write_pdf,
)
from matstd.report.pages.compare_page import write_compare_page
from matstd.report.pages.design_page import write_design_page
from matstd.report.pages.design_result import Design, Proven
from matstd.report.pages.diagnosis_page import write_diagnosis_page
from matstd.report.pages.notebook import drawing
from matstd.report.pages.setup_page import write_setup_page
from matstd.report.pages.study_page import write_study_page
from matstd.report.pages.time_section import machine_times
from matstd.report.pages.uncertainty_page import write_uncertainty_page

__all__ = [
    "Design",
    "Printer",
    "Proven",
    "drawing",
    "machine_times",
    "printer",
    "write_compare_page",
    "write_design_page",
    "write_diagnosis_page",
    "write_pdf",
    "write_setup_page",
    "write_study_page",
    "write_uncertainty_page",
]
