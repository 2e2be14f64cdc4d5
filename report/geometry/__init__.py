"""The machine's geometry and mistakes in its description, in words.

In: a `LearntGeometry`, `DescriptionFault`s, a `Trend`. Out: lines of a table and for the console,
numbers to copy into a machine file, a sentence for each mistake and for what changed between runs.
"""

from matstd.report.geometry.console_words import console_lines
from matstd.report.geometry.copied_numbers import copy_lines
from matstd.report.geometry.fault_words import fault_sentences
from matstd.report.geometry.geometry_words import (
    USUAL,
    correction_line,
    estimate_words,
    geometry_lines,
    quantity_name,
    shown_unit,
)
from matstd.report.geometry.page_section import geometry_section
from matstd.report.geometry.trend_words import change_sentences

__all__ = [
    "USUAL",
    "change_sentences",
    "console_lines",
    "copy_lines",
    "correction_line",
    "estimate_words",
    "fault_sentences",
    "geometry_lines",
    "geometry_section",
    "quantity_name",
    "shown_unit",
]
