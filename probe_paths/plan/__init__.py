"""What is touched, in which order, from which side."""

from probe_paths.plan.clearance import Room, obstacles, swing_height, top_height
from probe_paths.plan.frame import LINEAR, ProgramFrame
from probe_paths.plan.heading import Heading, parse_heading
from probe_paths.plan.order import Visit, home_readings, nearest_neighbours, waypoints
from probe_paths.plan.planner import plan_touches
from probe_paths.plan.probe import Probe
from probe_paths.plan.touch_plan import PlanOptions, TouchPlan, requests_at

__all__ = [
    "LINEAR",
    "Heading",
    "PlanOptions",
    "Probe",
    "ProgramFrame",
    "Room",
    "TouchPlan",
    "Visit",
    "home_readings",
    "nearest_neighbours",
    "obstacles",
    "parse_heading",
    "plan_touches",
    "requests_at",
    "swing_height",
    "top_height",
    "waypoints",
]
