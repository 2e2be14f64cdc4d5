"""HTML pages, each in one file that loads nothing from anywhere; notebook displays of results.

A page is a list of `Section`s (sentences, table, pictures) under a verdict and key figures;
`write_page` renders every page in the same way and writes its tables as CSV and workbook.
"""

from matstd.report.layout import Printer as Printer
from matstd.report.layout import printer as printer
from matstd.report.layout import write_pdf as write_pdf
from matstd.report.pages.compare_page import write_compare_page as write_compare_page
from matstd.report.pages.design_page import write_design_page as write_design_page
from matstd.report.pages.design_result import Design as Design
from matstd.report.pages.design_result import Proven as Proven
from matstd.report.pages.diagnosis_page import write_diagnosis_page as write_diagnosis_page
from matstd.report.pages.notebook import drawing as drawing
from matstd.report.pages.setup_page import write_setup_page as write_setup_page
from matstd.report.pages.study_page import write_study_page as write_study_page
from matstd.report.pages.time_section import machine_times as machine_times
from matstd.report.pages.uncertainty_page import Budgets as Budgets
from matstd.report.pages.uncertainty_page import write_uncertainty_page as write_uncertainty_page
