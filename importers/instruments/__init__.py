"""Tests of single axes and of circles: readings of lasers, autocollimators, encoders, ball bars."""

from matstd.importers.instruments.acceptance import component_range, positioning_figures
from matstd.importers.instruments.axis_run import one_axis_machine, positioning_run
from matstd.importers.instruments.circle import (
    CircleParameter,
    circle_machine,
    circle_parameters,
    circle_run,
    read_circle,
)
from matstd.importers.instruments.positioning import PositioningTest, read_positioning

__all__ = [
    "CircleParameter", "PositioningTest", "circle_machine", "circle_parameters", "circle_run",
    "component_range", "one_axis_machine", "positioning_figures", "positioning_run",
    "read_circle", "read_positioning",
]  # fmt: skip
