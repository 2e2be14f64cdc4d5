"""How surely touches and scans show smooth effects of a machine that no model has.

In: a `Measurement` of touches and points of scans on a standard. Out: a `HiddenPower`, signal and
power of fields over the workspace and of short errors of one axis, in every direction.
"""

from matstd.artefact.hidden.scan_lines import Scan, scanned
from matstd.artefact.hidden.scan_path import write_scan_path
from matstd.artefact.hidden.smooth_effects import (
    SIZE,
    HiddenEffect,
    HiddenPower,
    Measurement,
    hidden_effects,
    hidden_power,
    measured_together,
    possible_places,
    touched,
)
from matstd.artefact.hidden.touches_that_show import showing_poses, showing_touches

__all__ = [
    "SIZE",
    "HiddenEffect",
    "HiddenPower",
    "Measurement",
    "Scan",
    "hidden_effects",
    "hidden_power",
    "measured_together",
    "possible_places",
    "scanned",
    "showing_poses",
    "showing_touches",
    "touched",
    "write_scan_path",
]
