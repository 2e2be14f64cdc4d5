"""Tests of single axes and of circles: readings of lasers, autocollimators, encoders, ball bars."""

from matstd.importers.instruments.acceptance import component_range as component_range
from matstd.importers.instruments.acceptance import positioning_figures as positioning_figures
from matstd.importers.instruments.axis_run import one_axis_machine as one_axis_machine
from matstd.importers.instruments.axis_run import positioning_run as positioning_run
from matstd.importers.instruments.circle import CircleParameter as CircleParameter
from matstd.importers.instruments.circle import circle_machine as circle_machine
from matstd.importers.instruments.circle import circle_parameters as circle_parameters
from matstd.importers.instruments.circle import circle_run as circle_run
from matstd.importers.instruments.circle import read_circle as read_circle
from matstd.importers.instruments.positioning import PositioningTest as PositioningTest
from matstd.importers.instruments.positioning import read_positioning as read_positioning
