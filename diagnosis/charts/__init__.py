"""Control charts of one machine over dated runs: what changed, when, and how certainly.

In: runs of one machine and one standard, or the states that models of them give (`Occasion`). Out:
a `History` with a `ControlChart` for every charted quantity: values, Shewhart limits and what they
come from, steps with their date, or a drift with its rate.
"""

from matstd.diagnosis.charts.chart import ControlChart as ControlChart
from matstd.diagnosis.charts.chart import LimitSource as LimitSource
from matstd.diagnosis.charts.course import ALPHA as ALPHA
from matstd.diagnosis.charts.course import Drift as Drift
from matstd.diagnosis.charts.course import Step as Step
from matstd.diagnosis.charts.history_file import history_csv as history_csv
from matstd.diagnosis.charts.history_file import history_table as history_table
from matstd.diagnosis.charts.machine_history import MIN_OCCASIONS as MIN_OCCASIONS
from matstd.diagnosis.charts.machine_history import History as History
from matstd.diagnosis.charts.machine_history import history as history
from matstd.diagnosis.charts.occasion import Charted as Charted
from matstd.diagnosis.charts.occasion import Occasion as Occasion
from matstd.diagnosis.charts.occasion import Overall as Overall
from matstd.diagnosis.charts.occasion import occasions_of_models as occasions_of_models
from matstd.diagnosis.charts.occasion import occasions_of_runs as occasions_of_runs
