"""Geometry, mistakes and changes on the console, line by line."""

from collections.abc import Sequence

from matstd.diagnosis.answer import Trend
from matstd.diagnosis.faults import DescriptionFault
from matstd.diagnosis.geometry import LearntGeometry
from matstd.report.geometry.copied_numbers import copy_lines
from matstd.report.geometry.fault_words import fault_sentences
from matstd.report.geometry.geometry_words import far_lines, ladder_sentence, noted_lines
from matstd.report.geometry.trend_words import trend_lines
from matstd.twin.record import Touches


def console_lines(
    touches: Touches,
    geometry: LearntGeometry,
    faults: Sequence[DescriptionFault],
    trend: Trend | None = None,
) -> list[tuple[str, bool]]:
    """Lines, each with whether it should be read first; changes replace the notable quantities."""
    first = [(text, True) for text in fault_sentences(faults)]
    first += [(text, False) for text in copy_lines(touches, geometry, faults)]
    first += [(text, True) for text in trend_lines(trend)]
    noted = noted_lines(geometry) if trend is None else far_lines(geometry)
    return first + [(text, False) for text in (ladder_sentence(geometry), *noted)]
