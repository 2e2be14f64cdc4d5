"""What a page consists of, and how it becomes HTML, CSV and PDF.

A `Page` is a verdict with key figures and a list of `Section`s: sentences, a table, pictures.
`write_page` renders every page by one template and writes its tables beside it.
"""

from matstd.report.layout.html import marked as marked
from matstd.report.layout.html import picture as picture
from matstd.report.layout.html import write_page as write_page
from matstd.report.layout.pdf import Printer as Printer
from matstd.report.layout.pdf import printer as printer
from matstd.report.layout.pdf import write_pdf as write_pdf
from matstd.report.layout.section import Heading as Heading
from matstd.report.layout.section import KeyFigure as KeyFigure
from matstd.report.layout.section import LiveView as LiveView
from matstd.report.layout.section import Page as Page
from matstd.report.layout.section import Picture as Picture
from matstd.report.layout.section import Section as Section
from matstd.report.layout.section import Table as Table
