"""What is touched, in which order, from which side: the plan of one set-up of the standard.

Rotary positions are approached from both sides, poses come in mixed order and twice, the second
time backwards, so that every pose has the same mean time and a linear drift drops out of its mean.
On every visit a datum sphere is touched first, at the same point in both visits of a pose.
"""

from collections.abc import Mapping
from dataclasses import dataclass, field

import numpy as np

from matstd.artefact.body import Standard
from matstd.artefact.reach import DatumBall, ProbeReach, Requests, Workshop
from matstd.artefact.tool import OVERSHOOT, Probe
from matstd.probe_paths.plan.order import Visit
from matstd.twin.frames import Array
from matstd.twin.machine import Chain
from matstd.twin.record import IntArray, Labels, Setup
from matstd.twin.units import DEG

GRID = 1e-4 * DEG
"""Rotary readings are rounded to what a program can state, rad."""


@dataclass(frozen=True)
class PlanOptions:
    """Margins and thoroughness of a plan, base units.

    Angle and gap are wider than in the choice of touches (`ProbeReach`: 75 degrees and 2 mm), so
    that no chosen touch is refused because of rounding in a program; all other shared values are
    taken from there.

    Attributes:
        standoff: Gap between ball and surface at the start of a touch.
        search: How far beyond the expected contact the probe looks for the surface.
        clearance: Height of the tool above everything while it moves sideways.
        smallest_gap: Smallest gap between stylus, body, spindle and anything solid at a touch.
        overshoot: How far before a rotary position the last motion towards it begins, rad.
        steepest: Largest angle between the surface's normal and the tool axis, rad.
        retract: Below the upper end of Z's travel, where rotary axes may turn.
        anchor: Sphere touched on every visit; empty for the first of the standard.
        anchor_tilt: Angle between the anchor touch's normal and the tool axis, rad.
        shortest_visit: Fewest touches for which a pose is visited twice, half of them each time.
        workshop: What stands beside the standard and is kept clear.
        ball: Ball of the workshop where that is touched; the standard has it as a feature.
        tolerated: How many requests may be refused before the whole plan is.
        is_swept: Whether moves are swept with the whole tool; a plan that is timed and never run
            need not be.
    """

    standoff: float = ProbeReach.standoff
    search: float = ProbeReach.search
    clearance: float = 20.0
    smallest_gap: float = 1.0
    overshoot: float = OVERSHOOT
    steepest: float = 90.5 * DEG
    retract: float = 1.0
    anchor: str = ""
    anchor_tilt: float = 40.0 * DEG
    shortest_visit: int = 4
    workshop: Workshop = field(default_factory=Workshop)
    ball: DatumBall | None = None
    tolerated: int = 0
    is_swept: bool = True


def requests_at(standard: Standard, feature: str, uv: Array, rotary: Array) -> Requests:
    """Touches at parameters (N, 2) of one feature at rotary readings (N, R) or (R,), rad."""
    surface = standard.features[feature]
    rotary = np.broadcast_to(np.asarray(rotary, dtype=float), (len(uv), np.shape(rotary)[-1]))
    return Requests(np.full(len(uv), feature), surface.point(uv), surface.normal(uv), rotary)


@dataclass(frozen=True)
class Refusal:
    """A request that cannot be made.

    Attributes:
        request: Row of the requests; -1 for an anchor touch.
        rotary: Readings of the rotary axes by letter, rad.
        reason: What is against it, as `ProbeReach.reasons` has it.
    """

    request: int
    feature: str
    rotary: Mapping[str, float]
    reason: str

    def __str__(self) -> str:
        place = " ".join(f"{a}{v / DEG:+.1f}" for a, v in self.rotary.items())
        return f"{self.feature}, {place}: {self.reason}"


@dataclass(frozen=True, eq=False)
class TouchPlan:
    """Touches in the order of execution; rows of one visit stand together.

    Attributes:
        visits: Table poses in order, each with its side of approach and clearance height.
        visit: Index into `visits`, (N,).
        request: Row of the requests, -1 for an anchor touch, (N,).
        point: Contact points, artefact frame, (N, 3), mm.
        start: Readings at the start of the touch, (N, A).
        contact: Readings at the expected contact, (N, A).
        direction: Unit vector of the probing motion in X, Y, Z readings, (N, 3).
        refused: Requests that cannot be made, and why.
    """

    chain: Chain
    probe: Probe
    standard: Standard
    setup: Setup
    options: PlanOptions
    visits: tuple[Visit, ...]
    visit: IntArray
    request: IntArray
    feature: Labels
    point: Array
    normal: Array
    start: Array
    contact: Array
    direction: Array
    refused: tuple[Refusal, ...] = field(default=())

    def __len__(self) -> int:
        return len(self.visit)

    @property
    def distance(self) -> float:
        """Longest path of a touch, mm."""
        return self.options.standoff + self.options.search
