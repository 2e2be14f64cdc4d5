"""HTML pages, each in one file that loads nothing from anywhere; what results show in a notebook.

`write_page` renders a template of `templates/`; a module for each page turns a result into the
numbers, rows and pictures that its template shows.
"""

from matstd.report.pages.compare_page import write_compare_page
from matstd.report.pages.design_page import write_design_page
from matstd.report.pages.design_result import Design, Proven
from matstd.report.pages.diagnosis_page import write_diagnosis_page
from matstd.report.pages.notebook import drawing
from matstd.report.pages.page import write_page
from matstd.report.pages.pdf import Printer, printer, write_pdf
from matstd.report.pages.residual_section import Picture
from matstd.report.pages.setup_page import write_setup_page
from matstd.report.pages.study_page import write_study_page
from matstd.report.pages.uncertainty_page import write_uncertainty_page

__all__ = [
    "Design",
    "Picture",
    "Printer",
    "Proven",
    "drawing",
    "printer",
    "write_compare_page",
    "write_design_page",
    "write_diagnosis_page",
    "write_page",
    "write_pdf",
    "write_setup_page",
    "write_study_page",
    "write_uncertainty_page",
]
