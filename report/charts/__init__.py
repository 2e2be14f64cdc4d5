"""Control charts of a machine over several occasions: sentences, pictures and the page.

In: a `History`. Out: what changed and when, in words; charts with their limits; `report.html`.
"""

from matstd.report.charts.chart_page import write_history_page as write_history_page
from matstd.report.charts.chart_words import history_lines as history_lines
from matstd.report.charts.chart_words import history_sentence as history_sentence
