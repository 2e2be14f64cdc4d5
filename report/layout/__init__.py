"""What a page consists of, and how it becomes HTML, CSV and PDF.

A `Page` is a verdict with key figures and a list of `Section`s: sentences, a table, pictures.
`write_page` renders every page by one template and writes its tables beside it.
"""

from matstd.report.layout.html import marked, picture, write_page
from matstd.report.layout.pdf import Printer, printer, write_pdf
from matstd.report.layout.section import Heading, KeyFigure, LiveView, Page, Picture, Section, Table

__all__ = [
    "Heading",
    "KeyFigure",
    "LiveView",
    "Page",
    "Picture",
    "Printer",
    "Section",
    "Table",
    "marked",
    "picture",
    "printer",
    "write_page",
    "write_pdf",
]
