"""The geometry of the machine, and mistakes in its description, in words.

In: a `LearntGeometry`, `DescriptionFault`s, a `Trend`. Out: lines for tables and console, numbers
to copy into a machine file, sentences on mistakes and changes.
"""

from matstd.report.geometry.copied_numbers import copy_lines
from matstd.report.geometry.fault_words import fault_sentences
from matstd.report.geometry.geometry_section import geometry_sections
from matstd.report.geometry.geometry_words import USUAL, estimate_words, quantity_name, shown_unit
from matstd.report.geometry.trend_words import change_sentences, console_lines

__all__ = [
    "USUAL",
    "change_sentences",
    "console_lines",
    "copy_lines",
    "estimate_words",
    "fault_sentences",
    "geometry_sections",
    "quantity_name",
    "shown_unit",
]
