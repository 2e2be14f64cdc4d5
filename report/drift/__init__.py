"""Laws of a thermal drift in words, pictures and on a page: each beside the others."""

from matstd.report.drift.drift_page import draw_drift as draw_drift
from matstd.report.drift.drift_page import write_drift_page as write_drift_page
from matstd.report.drift.drift_words import clock_line as clock_line
from matstd.report.drift.drift_words import drift_lines as drift_lines
from matstd.report.drift.drift_words import kept_line as kept_line
from matstd.report.drift.drift_words import law_title as law_title
