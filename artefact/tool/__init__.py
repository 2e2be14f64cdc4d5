"""The touch probe in the spindle, and heights of Z at which it clears what stands on the table.

In: a probe, a standard in its set-up, a workshop. Out: the probe as a body, and readings of Z. The
design looks at them before it begins, the planner for every visit of a table pose.
"""

from matstd.artefact.tool.heights import (
    OVERSHOOT,
    home_readings,
    readings_at,
    solid_hull,
    swing_height,
    top_height,
)
from matstd.artefact.tool.probe import Probe

__all__ = [
    "OVERSHOOT",
    "Probe",
    "home_readings",
    "readings_at",
    "solid_hull",
    "swing_height",
    "top_height",
]
