"""The live view of a run: effects to switch, and the error that the model leaves with them.

In: a `Board`, which holds what the error of any set of effects follows from. Out: `run_view`, the
`LiveView` of a page: its data, read by `report/live/pages/run_page.js`, which refits in the
browser.
"""

from matstd.report.run_view.next_step import comparison_step as comparison_step
from matstd.report.run_view.next_step import diagnosis_step as diagnosis_step
from matstd.report.run_view.run_data import Findings as Findings
from matstd.report.run_view.view import Framed as Framed
from matstd.report.run_view.view import comparison_view as comparison_view
from matstd.report.run_view.view import diagnosis_view as diagnosis_view
from matstd.report.run_view.view import learnt_view as learnt_view
from matstd.report.run_view.view import run_view as run_view
