"""The touch probe in the spindle, and heights of Z at which it clears what stands on the table.

In: a probe, a standard in its set-up, a workshop. Out: the probe as a body, and readings of Z. The
design looks at them before it begins, the planner for every visit of a table pose.
"""

from matstd.artefact.tool.heights import NOSE_HEIGHT as NOSE_HEIGHT
from matstd.artefact.tool.heights import OVERSHOOT as OVERSHOOT
from matstd.artefact.tool.heights import Probe as Probe
from matstd.artefact.tool.heights import home_readings as home_readings
from matstd.artefact.tool.heights import readings_at as readings_at
from matstd.artefact.tool.heights import solid_hull as solid_hull
from matstd.artefact.tool.heights import swing_height as swing_height
from matstd.artefact.tool.heights import top_height as top_height
