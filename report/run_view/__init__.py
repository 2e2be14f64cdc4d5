"""The live view of a run: effects to switch, and the error that the model leaves with them.

In: a `Board`, which holds what the error of any set of effects follows from. Out: `run_view`, the
`LiveView` of a page: its data, read by `report/live/pages/run_page.js`, which refits in the
browser.
"""

from matstd.report.run_view.next_step import comparison_step, diagnosis_step
from matstd.report.run_view.run_data import Findings
from matstd.report.run_view.view import (
    Framed,
    comparison_view,
    diagnosis_view,
    learnt_view,
    run_view,
)

__all__ = [
    "Findings",
    "Framed",
    "comparison_step",
    "comparison_view",
    "diagnosis_step",
    "diagnosis_view",
    "learnt_view",
    "run_view",
]
