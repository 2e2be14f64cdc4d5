"""How surely touches and scans show smooth effects of a machine that no model has.

In: a `Measurement` of touches and points of scans on a standard. Out: a `HiddenPower`, signal and
power of fields over the workspace and of short errors of one axis, in every direction.
"""

from matstd.artefact.hidden.scan_lines import Scan as Scan
from matstd.artefact.hidden.scan_lines import scanned as scanned
from matstd.artefact.hidden.scan_path import write_scan_path as write_scan_path
from matstd.artefact.hidden.smooth_effects import SIZE as SIZE
from matstd.artefact.hidden.smooth_effects import HiddenEffect as HiddenEffect
from matstd.artefact.hidden.smooth_effects import HiddenPower as HiddenPower
from matstd.artefact.hidden.smooth_effects import Measurement as Measurement
from matstd.artefact.hidden.smooth_effects import hidden_effects as hidden_effects
from matstd.artefact.hidden.smooth_effects import hidden_power as hidden_power
from matstd.artefact.hidden.smooth_effects import measured_together as measured_together
from matstd.artefact.hidden.smooth_effects import possible_places as possible_places
from matstd.artefact.hidden.smooth_effects import touched as touched
from matstd.artefact.hidden.touches_that_show import showing_poses as showing_poses
from matstd.artefact.hidden.touches_that_show import showing_touches as showing_touches
