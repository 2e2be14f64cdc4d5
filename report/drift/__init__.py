"""Laws of a thermal drift in words, pictures and on a page: each beside the others."""

from matstd.report.drift.drift_page import draw_drift, write_drift_page
from matstd.report.drift.drift_words import clock_line, drift_lines, kept_line, law_title

__all__ = [
    "clock_line",
    "draw_drift",
    "drift_lines",
    "kept_line",
    "law_title",
    "write_drift_page",
]
