"""What is touched, in which order, from which side: the plan of one set-up of the standard.

Rotary positions are approached from both sides, poses come in mixed order and twice, the second
time backwards, so that every pose has the same mean time and a linear drift drops out of its mean.
On every visit a datum sphere is touched first, at the same point in both visits of a pose.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from functools import cached_property

import numpy as np

from matstd.artefact.body import DatumSphere, Standard
from matstd.artefact.reach import DatumBall, ProbeReach, Requests, Workshop
from matstd.artefact.tool import OVERSHOOT, Probe, readings_at
from matstd.probe_paths.plan.clearance import ToolClearance
from matstd.probe_paths.plan.frame import ProgramFrame
from matstd.probe_paths.plan.head import HeadTurns, head_turns
from matstd.probe_paths.plan.order import Visit
from matstd.twin.display import Displayed
from matstd.twin.frames import Array, IntArray
from matstd.twin.machine import Chain, table_to_tool
from matstd.twin.record import Labels, Setup
from matstd.twin.units import DEG

GRID = 1e-4 * DEG  # rotary readings are rounded to what a program can state, rad


@dataclass(frozen=True)
class PlanOptions:
    """Margins and thoroughness of a plan, base units.

    Angle and gap are wider than in the choice of touches (`ProbeReach`: 75 degrees and 2 mm), so
    that no chosen touch is refused because of rounding in a program; all other shared values are
    taken from there.
    """

    standoff: float = ProbeReach.standoff  # gap between ball and surface at the start of a touch
    # how far beyond the expected contact the probe looks for the surface
    search: float = ProbeReach.search
    clearance: float = 20.0  # height of the tool above everything while it moves sideways
    # smallest gap between stylus, body, spindle and anything solid at a touch
    smallest_gap: float = 1.0
    # how far before a rotary position the last motion towards it begins, rad
    overshoot: float = OVERSHOOT
    # largest angle between the surface's normal and the tool axis, rad
    steepest: float = 90.5 * DEG
    retract: float = 1.0  # below the upper end of Z's travel, where rotary axes may turn
    anchor: str = ""  # sphere touched on every visit; empty for the first of the standard
    # angle between the anchor touch's normal and the tool axis, rad
    anchor_tilt: float = 40.0 * DEG
    # fewest touches for which a pose is visited twice, half of them each time
    shortest_visit: int = 4
    # what stands beside the standard and is kept clear
    workshop: Workshop = field(default_factory=Workshop)
    # ball of the workshop where that is touched; the standard has it as a feature
    ball: DatumBall | None = None
    tolerated: int = 0  # how many requests may be refused before the whole plan is
    # whether moves are swept with the whole tool; a plan that is timed and never run need not be
    is_swept: bool = True


def requests_at(standard: Standard, feature: str, uv: Array, rotary: Array) -> Requests:
    """Touches at parameters (N, 2) of one feature at rotary readings (N, R) or (R,), rad."""
    surface = standard.features[feature]
    rotary = np.broadcast_to(np.asarray(rotary, dtype=float), (len(uv), np.shape(rotary)[-1]))
    return Requests(np.full(len(uv), feature), surface.point(uv), surface.normal(uv), rotary)


def ring_requests(
    chain: Chain, setup: Setup, spheres: Sequence[DatumSphere], rotary: Array, along: Array
) -> Requests:
    """Touches on balls at rotary readings (R,), along normals (K, 3) in the tool frame."""
    R_table_tool = table_to_tool(chain, readings_at(chain, rotary[None]))[0, :3, :3]
    normal = along @ R_table_tool.T @ setup.T_table_artefact[:3, :3]
    return Requests(
        np.repeat([s.name for s in spheres], len(normal)),
        np.concatenate([s.centre + s.radius * normal for s in spheres]),
        np.tile(normal, (len(spheres), 1)),
        np.repeat(rotary[None], len(spheres) * len(normal), axis=0),
    )


def ring_normals(angle: float, azimuth: Array) -> Array:
    """Unit vectors at an angle to z, (K, 3), from their azimuths (K,), rad."""
    sin, cos = np.sin(angle), np.cos(angle)
    x, y = sin * np.cos(azimuth), sin * np.sin(azimuth)
    return np.stack([x, y, np.full(len(azimuth), cos)], axis=-1)


@dataclass(frozen=True)
class Refusal:
    """A request that cannot be made."""

    request: int  # row of the requests; -1 for an anchor touch
    feature: str
    rotary: Mapping[str, float]  # readings of the rotary axes by letter, rad
    reason: str  # what is against it, as `ProbeReach.reasons` has it

    def __str__(self) -> str:
        place = " ".join(f"{a}{v / DEG:+.1f}" for a, v in self.rotary.items())
        return f"{self.feature}, {place}: {self.reason}"


@dataclass(frozen=True, eq=False)
class PlanTask:
    """What is planned: a standard in a set-up, the machine that probes it, and the margins."""

    chain: Chain
    probe: Probe
    standard: Standard
    setup: Setup
    options: PlanOptions

    @cached_property
    def clearance(self) -> ToolClearance:
        """Room for the tool."""
        workshop = self.options.workshop
        return ToolClearance(self.chain, self.standard, self.setup, self.probe, workshop=workshop)

    @cached_property
    def frame(self) -> ProgramFrame:
        """Words of programs."""
        return ProgramFrame(self.chain, self.probe)

    @property
    def top(self) -> float:
        """Reading of Z where rotary axes may turn, mm."""
        return self.chain.link("Z").range[1] - self.options.retract

    def reach(self, room: float = -np.inf) -> ProbeReach:
        """What can be touched with these margins and some room, mm; whatever the room without."""
        return ProbeReach(
            chain=self.chain,
            setup=self.setup,
            shape=self.probe.shape,
            length=self.probe.length,
            steepest=self.options.steepest,
            room=room,
            standoff=self.options.standoff,
            search=self.options.search,
            workshop=self.options.workshop,
        )


@dataclass(frozen=True, eq=False, repr=False)
class TouchPlan(Displayed, PlanTask):
    """Touches in the order of execution; rows of one visit stand together."""

    # table poses in order, each with its side of approach and clearance height
    visits: tuple[Visit, ...]
    visit: IntArray  # index into `visits`, (N,)
    request: IntArray  # row of the requests, -1 for an anchor touch, (N,)
    feature: Labels
    point: Array  # contact points, artefact frame, (N, 3), mm
    normal: Array
    start: Array  # readings at the start of the touch, (N, A)
    contact: Array  # readings at the expected contact, (N, A)
    direction: Array  # unit vector of the probing motion in X, Y, Z readings, (N, 3)
    refused: tuple[Refusal, ...] = field(default=())  # requests that cannot be made, and why

    def __len__(self) -> int:
        return len(self.visit)

    @cached_property
    def head_turns(self) -> HeadTurns | None:
        """Where a head turns and what it sweeps; None where no rotary axis carries the tool.

        All programs of a probe in a set-up have the same place.
        """
        rotary = np.array([r for visit in self.visits for r in (visit.before, visit.rotary)])
        place = self.setup.T_table_artefact
        return head_turns(self.chain, self.probe, place, self.top, rotary)

    @property
    def distance(self) -> float:
        """Longest path of a touch, mm."""
        return self.options.standoff + self.options.search
