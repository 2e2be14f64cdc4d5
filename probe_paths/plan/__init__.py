"""What is touched, in which order, from which side.

In: a standard, a machine, a probe, a set-up, wanted touches. Out: a `TouchPlan` in axis readings,
with the requests that were refused. Gaps of the tool are worked out here for plan and collision
check alike (`ToolClearance`), heights in `matstd.artefact.tool`. A rule for the order of poses goes
into `order`.
"""

from matstd.artefact.tool import Probe, home_readings
from matstd.probe_paths.plan.clearance import SMALLEST_GAP, ToolClearance, stroke_gaps
from matstd.probe_paths.plan.frame import LINEAR, ProgramFrame
from matstd.probe_paths.plan.heading import (
    Heading,
    Sensor,
    calibration_hash,
    parse_heading,
    stated_serial,
)
from matstd.probe_paths.plan.order import StatedVisits, Visit, short_order, waypoints
from matstd.probe_paths.plan.planner import plan_touches
from matstd.probe_paths.plan.touch_plan import (
    PlanOptions,
    Refusal,
    TouchPlan,
    requests_at,
    ring_normals,
    ring_requests,
)

__all__ = [
    "LINEAR",
    "SMALLEST_GAP",
    "Heading",
    "PlanOptions",
    "Probe",
    "ProgramFrame",
    "Refusal",
    "Sensor",
    "StatedVisits",
    "ToolClearance",
    "TouchPlan",
    "Visit",
    "calibration_hash",
    "home_readings",
    "parse_heading",
    "plan_touches",
    "requests_at",
    "ring_normals",
    "ring_requests",
    "short_order",
    "stated_serial",
    "stroke_gaps",
    "waypoints",
]
