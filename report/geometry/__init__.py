"""The geometry of the machine, and mistakes in its description, in words.

In: a `LearntGeometry`, `DescriptionFault`s, a `Trend`. Out: lines for tables and console, numbers
to copy into a machine file, sentences on mistakes and changes.
"""

from matstd.report.geometry.copied_numbers import copy_lines as copy_lines
from matstd.report.geometry.fault_words import fault_sentences as fault_sentences
from matstd.report.geometry.geometry_section import geometry_sections as geometry_sections
from matstd.report.geometry.geometry_words import USUAL as USUAL
from matstd.report.geometry.geometry_words import estimate_words as estimate_words
from matstd.report.geometry.geometry_words import quantity_name as quantity_name
from matstd.report.geometry.geometry_words import shown_unit as shown_unit
from matstd.report.geometry.trend_words import change_sentences as change_sentences
from matstd.report.geometry.trend_words import console_lines as console_lines
