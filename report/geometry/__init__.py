"""The machine's geometry and mistakes in its description, in words.

In: a `LearntGeometry`, `DescriptionFault`s. Out: lines of a table and for the console, numbers to
copy into a machine file, a sentence for each mistake.
"""

from report.geometry.fault_words import fault_sentences
from report.geometry.geometry_words import (
    correction_line,
    geometry_lines,
    ladder_sentence,
    noted_lines,
    quantity_name,
    shown_unit,
    sized,
)
from report.geometry.trend_words import change_sentences, trend_lines

__all__ = [
    "change_sentences",
    "correction_line",
    "fault_sentences",
    "geometry_lines",
    "ladder_sentence",
    "noted_lines",
    "quantity_name",
    "shown_unit",
    "sized",
    "trend_lines",
]
