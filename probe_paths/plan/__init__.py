"""What is touched, in which order, from which side.

In: a standard, a machine, a probe, a set-up, wanted touches. Out: a `TouchPlan` in axis readings,
with the requests that were refused. Gaps of the tool are worked out here for plan and collision
check alike (`ToolClearance`), heights in `matstd.artefact.tool`. A rule for the order of poses goes
into `order`.
"""

from matstd.artefact.tool import Probe as Probe
from matstd.artefact.tool import home_readings as home_readings
from matstd.probe_paths.plan.clearance import SMALLEST_GAP as SMALLEST_GAP
from matstd.probe_paths.plan.clearance import ToolClearance as ToolClearance
from matstd.probe_paths.plan.clearance import stroke_gaps as stroke_gaps
from matstd.probe_paths.plan.frame import LINEAR as LINEAR
from matstd.probe_paths.plan.frame import ProgramFrame as ProgramFrame
from matstd.probe_paths.plan.head import HeadTurns as HeadTurns
from matstd.probe_paths.plan.heading import Heading as Heading
from matstd.probe_paths.plan.heading import Sensor as Sensor
from matstd.probe_paths.plan.heading import calibration_hash as calibration_hash
from matstd.probe_paths.plan.heading import parse_heading as parse_heading
from matstd.probe_paths.plan.heading import stated_serial as stated_serial
from matstd.probe_paths.plan.order import StatedVisits as StatedVisits
from matstd.probe_paths.plan.order import Visit as Visit
from matstd.probe_paths.plan.order import short_order as short_order
from matstd.probe_paths.plan.order import waypoints as waypoints
from matstd.probe_paths.plan.planner import plan_touches as plan_touches
from matstd.probe_paths.plan.touch_plan import PlanOptions as PlanOptions
from matstd.probe_paths.plan.touch_plan import PlanTask as PlanTask
from matstd.probe_paths.plan.touch_plan import Refusal as Refusal
from matstd.probe_paths.plan.touch_plan import TouchPlan as TouchPlan
from matstd.probe_paths.plan.touch_plan import requests_at as requests_at
from matstd.probe_paths.plan.touch_plan import ring_normals as ring_normals
from matstd.probe_paths.plan.touch_plan import ring_requests as ring_requests
