"""Points of a scan on a face, and what they are worth beside single touches.

The probe follows lines over the face and a point is recorded every few hundredths of a second.
Points of one line share part of their noise, ``exp(-distance / memory)``: a thousand points are not
a thousand measurements. For a design the points of a stretch of line are one mean, with

    var = u^2 / k^2 sum_ij r^|i - j|,   r = exp(-pitch / memory)

that is as good as independent of the next where the stretch is a few times the memory.
"""

from dataclasses import dataclass

import numpy as np

from matstd.artefact.body import FreeformPatch, Standard
from matstd.artefact.hidden.smooth_effects import Measurement
from matstd.artefact.reach import ProbeReach, Requests, joined
from matstd.artefact.worth import each_at
from matstd.twin.frames import Array, Mask
from matstd.twin.sampling import grid_points
from matstd.twin.units import UM

_STRETCH = 8.0  # mm of line in one mean: less than half of the narrowest effect that is asked for
EDGE = 3.0  # distance of lines from the trimmed edge, mm


@dataclass(frozen=True)
class Scan:
    """How a face is scanned."""

    between: float = 5.0  # distance of two lines, mm
    pitch: float = 2.5  # distance of two recorded points on a line, mm
    u: float = 2.0 * UM  # standard uncertainty of a point by its noise, mm
    memory: float = 1.0  # distance over which that noise falls to 1/e, mm
    feed: float = 1000.0  # mm/min

    @property
    def u_of_mean(self) -> float:
        """Standard uncertainty of the mean of a stretch, mm."""
        k = max(1, round(_STRETCH / self.pitch))
        i = np.arange(k)
        alike = np.exp(-self.pitch / self.memory) ** np.abs(i[:, None] - i) if self.memory else 1.0
        total = float(np.sum(alike)) if self.memory else float(k)
        return self.u * np.sqrt(total) / k

    def points(self, face: FreeformPatch) -> int:
        """Number of recorded points on a face."""
        a, b = (2.0 * (half - EDGE) for half in face.half_size)
        return int((a // self.between + 1) * (b // self.pitch + 1))

    def minutes(self, face: FreeformPatch) -> float:
        """Duration of the lines and of the ways between them, min: slopes are followed."""
        a, b = (2.0 * (half - EDGE) for half in face.half_size)
        longer = float(np.mean(1.0 / np.cos(face.slope(face.grid(4.0)))))
        return ((a // self.between + 1) * b * longer + a) / self.feed


def can_be_scanned(wanted: Requests, reach: ProbeReach, standard: Standard) -> Mask:
    """Points within angle and travels at which nothing comes near the probe above its ball, (N,).

    From such a point the probe leaves along the tool axis without meeting anything: nowhere is it
    wider than above.
    """
    can: Mask = reach.is_reachable(wanted)
    can[can] = reach.has_room(standard, wanted[can], is_near_lid=True)
    return can


def scanned(
    face: FreeformPatch, scan: Scan, poses: Array, reach: ProbeReach, standard: Standard
) -> Measurement:
    """Means of the stretches of a scan that can be made at table poses (K, R), rad."""
    a, b = (half - EDGE for half in face.half_size)
    # as many means a length across the lines as along them: neighbours of several lines are one too
    across = max(1, round(_STRETCH / scan.between))
    u = np.arange(-a, a + 1e-9, across * scan.between)
    v = np.arange(-b, b + 1e-9, _STRETCH)
    grid = grid_points(u, v)
    wanted = joined([each_at(face, grid, pose[None]) for pose in poses])
    wanted = wanted[can_be_scanned(wanted, reach, standard)]
    sd = scan.u_of_mean / np.sqrt(across)
    return Measurement(wanted, np.full(len(wanted), sd), np.zeros(len(wanted)))
