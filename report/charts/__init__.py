"""Control charts of a machine over several occasions: sentences, pictures and the page.

In: a `History`. Out: what changed and when, in words; charts with their limits; `report.html`.
"""

from matstd.report.charts.chart_page import write_history_page
from matstd.report.charts.chart_words import history_lines, history_sentence

__all__ = ["history_lines", "history_sentence", "write_history_page"]
