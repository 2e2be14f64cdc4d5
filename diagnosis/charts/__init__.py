"""Control charts of one machine over dated runs: what changed, when, and how certainly.

In: runs of one machine and one standard, or the states that models of them give (`Occasion`). Out:
a `History` with a `ControlChart` for every charted quantity: values, Shewhart limits and what they
come from, steps with their date, or a drift with its rate.
"""

from matstd.diagnosis.charts.chart import ControlChart, LimitSource, Segment
from matstd.diagnosis.charts.course import ALPHA, Drift, Step
from matstd.diagnosis.charts.history_file import history_csv, history_table
from matstd.diagnosis.charts.machine_history import MIN_OCCASIONS, History, history
from matstd.diagnosis.charts.occasion import (
    Charted,
    Occasion,
    Overall,
    occasions_of_models,
    occasions_of_runs,
)

__all__ = [
    "ALPHA",
    "MIN_OCCASIONS",
    "Charted",
    "ControlChart",
    "Drift",
    "History",
    "LimitSource",
    "Occasion",
    "Overall",
    "Segment",
    "Step",
    "history",
    "history_csv",
    "history_table",
    "occasions_of_models",
    "occasions_of_runs",
]
