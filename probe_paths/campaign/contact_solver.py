"""Contacts of true balls with true surfaces, all touches of a program at once: Newton's method."""

from collections.abc import Callable
from dataclasses import dataclass, field
from datetime import datetime

import numpy as np

from matstd.artefact.body import DatumSphere, Meeting, Standard, contact
from matstd.probe_paths.campaign.disturbances import Disturbance
from matstd.probe_paths.control import Clock, ReadProgram
from matstd.probe_paths.language import Dialect
from matstd.twin.frames import Array, IntArray, Mask, apply, inverse, turn
from matstd.twin.machine import Chain, Contribution, exact_tip, linear_directions, tip
from matstd.twin.record import Setup, Touches
from matstd.twin.units import NM

CONTACT_TOLERANCE = 1e-3 * NM  # the ball touches when its gap is this small, mm
_STEPS = 12  # limit for Newton's method; with errors of ordinary size four sufficed
_BEYOND_END = 10.0  # mm beyond the end of a touch: far more than the errors of a working machine

FIRST_MORNING = datetime(2000, 1, 1, 8, 0, 0)
"""Start of a simulated campaign: a fixed date, so that results do not depend on today's."""

_SMALLEST_U = 1e-5
"""Uncertainty stated where no noise is simulated, mm: a run file cannot state none."""


@dataclass(frozen=True, eq=False)
class VirtualMachine:
    """The machine as it really is, known to the simulator only."""

    chain: Chain  # nominal kinematics
    # what all errors add at given touches; None for a perfect machine
    disturbance: Disturbance | None = None
    # pose (4, 4) of the standard where it really stands, seen from where it is believed to stand
    # (artefact frame)
    setup_error: Array = field(default_factory=lambda: np.eye(4))
    radius_error: float = 0.0  # radius of the true ball minus the calibrated one, mm
    length_error: float = 0.0  # length of the true probe minus the calibrated one, mm
    noise: float = 0.0  # standard deviation of the trigger along the normal, mm
    begin: datetime = FIRST_MORNING
    clock: Clock = field(default_factory=Clock)
    dialect: Dialect = field(default_factory=Dialect)
    # reading of a sensor by name at a time since the campaign began (s), degC
    temperature: Callable[[str, float], float] = lambda name, now: 20.0

    @property
    def stated_u(self) -> float:
        """Uncertainty of a touch that its run states, mm."""
        return max(self.noise, _SMALLEST_U)


class ContactSolver:
    """Solves all touches of a program at once."""

    def __init__(
        self, program: ReadProgram, standard: Standard, machine: VirtualMachine, noise: Array
    ) -> None:
        touches = program.touches
        self.program, self.machine, self.noise = program, machine, noise
        probe = program.heading.probe
        self.radius, self.length = probe.radius, probe.length
        self.start = np.array([t.q for t in touches]).reshape(-1, len(machine.chain.axes))
        self.direction = np.array([t.direction for t in touches]).reshape(self.start.shape)
        self.distance = np.array([t.distance for t in touches])
        believed = program.heading.setup.T_table_artefact
        stands = believed @ machine.setup_error
        self.T_artefact_table = inverse(stands)
        # a ball on the table stands where it does, wherever the standard does
        self.standard = program.heading.touched(standard, stands)
        self.disturbance = machine.disturbance
        self._nominal_contact()
        self.moved = self.standard.moved(machine.chain, self.start, stands, self.feature)

    def _nominal_contact(self) -> None:
        """First contact of every ball with the standard at its true place, on a perfect machine."""
        chain = self.machine.chain
        D = linear_directions(chain, self.start)
        motion = np.einsum("nij,nj->ni", D, self.direction[:, chain.linear_columns])
        self.motion = turn(self.T_artefact_table, motion)  # (N, 3) of the ball per mm of travel
        centre = apply(self.T_artefact_table, tip(chain, self.start, self.length))
        # errors may advance a contact a little; surfaces farther off are ignored
        latest = self.distance + _BEYOND_END
        hit = contact(self.standard, centre, self.motion, self.radius, latest)
        self.meeting = hit.meeting
        self.feature = hit.feature.astype(str)
        met = self.is_contact
        self.travel = np.where(met, hit.travel, self.distance)
        self.gap = np.zeros(len(hit.travel))  # left between ball and surface, mm
        self.uv = np.where(met[:, None], hit.uv, 0.0)
        self.point = np.where(met[:, None], hit.point, 0.0)
        self.normal = np.where(met[:, None], hit.normal, -self.motion)

    @property
    def is_contact(self) -> Mask:
        """Touches of a surface, which the control reports as a contact, (N,)."""
        mask: Mask = self.meeting == Meeting.SURFACE
        if self.program.is_search:
            mask |= (self.meeting == Meeting.EDGE) | (self.meeting == Meeting.SIDE)
        return mask

    @property
    def q(self) -> Array:
        """Readings where the balls stand now, (N, A)."""
        return self.start + self.travel[:, None] * self.direction

    def solve(self, time: Array) -> None:
        """Move the axes until the true balls touch.

        Newton on ``f(t) = n . (c(t) - S) - (radius + bias + noise)``, with c the true ball centre
        at the actual readings, S its foot point on the surface and n the normal there. Errors
        hardly vary along the way, so the slope is that of the perfect machine.
        """
        self._meet_sides(time)
        met = np.flatnonzero(self.meeting == Meeting.SURFACE)
        for _ in range(_STEPS if len(met) else 0):
            centre, radius = self._true_balls(met, time)
            for name in dict.fromkeys(self.feature[met].tolist()):
                mine = np.flatnonzero(self.feature[met] == name)
                surface = self.standard.features[name]
                uv = surface.project(centre[mine])
                self.uv[met[mine]] = uv
                self.point[met[mine]], self.normal[met[mine]] = (
                    surface.point(uv),
                    surface.normal(uv),
                )
            n = self.normal[met]
            gap = np.einsum("ni,ni->n", n, centre - self.point[met]) - radius
            slope = np.einsum("ni,ni->n", n, self.motion[met])
            self.gap[met] = gap
            self.travel[met] -= np.where(np.isfinite(gap), gap, 0.0) / slope
            if np.all(np.abs(gap) < CONTACT_TOLERANCE):
                break

    def _meet_sides(self, time: Array) -> None:
        """Edges and sides that a search meets: marched again with the displaced ball."""
        rows = np.flatnonzero(self.is_contact & (self.meeting != Meeting.SURFACE))
        if not len(rows):
            return
        chain, motion = self.machine.chain, self.motion[rows]
        true, _ = self._true_balls(rows, time)
        believed = apply(self.T_artefact_table, tip(chain, self.q[rows], self.length))
        start = apply(self.T_artefact_table, tip(chain, self.start[rows], self.length))
        hit = contact(self.standard, start + true - believed, motion, self.radius)
        self.travel[rows] = np.where(np.isfinite(hit.travel), hit.travel, self.travel[rows])

    def _true_balls(self, rows: IntArray, time: Array) -> tuple[Array, Array]:
        """True ball centres (M, 3) relative to the sagging features, and radii (M,)."""
        chain = self.machine.chain
        touches = self.touches(time, rows)
        added = Contribution.zeros(len(rows), len(chain.links))
        if self.disturbance is not None:
            added = self.disturbance(touches)
        length = self.length + self.machine.length_error
        actual = exact_tip(chain, touches.q, length, added) - added.shift
        radius = self.radius + self.machine.radius_error + added.bias + self.noise[rows]
        return apply(self.T_artefact_table, actual) - self.moved[rows], radius

    def touches(self, time: Array, rows: IntArray | None = None) -> Touches:
        """The record on which effects act, of all touches or some.

        Args:
            time: Time of the trigger of all touches, (N,), s since the start of the campaign.
        """
        rows = np.arange(len(self.start)) if rows is None else rows
        chain = self.machine.chain
        probings = self.program.touches
        side = np.array([probings[i].side for i in rows])
        return Touches(
            chain=chain,
            q=self.q[rows],
            length=np.full(len(rows), self.length),
            radius=np.full(len(rows), self.radius),
            point=self.point[rows],
            normal=self.normal[rows],
            setups=(Setup(self.program.heading.setup.name, inverse(self.T_artefact_table)),),
            setup=np.zeros(len(rows), dtype=np.int64),
            time=time[rows],
            approach=np.where(self.direction[rows] != 0.0, np.sign(self.direction[rows]), side),
            feature=self.feature[rows],
            pose=np.array([probings[i].pose for i in rows]),
        )

    def classify(self) -> None:
        """Mark the touches that the control would not report as a contact."""
        failures = [
            (~(np.abs(self.gap) < 1e3 * CONTACT_TOLERANCE), Meeting.UNRESOLVED),
            (self.travel < 0.0, Meeting.INSIDE),
            (self.travel > self.distance, Meeting.NOTHING),
        ]
        for name in dict.fromkeys(self.feature.tolist()):
            if name in self.standard.features:
                surface = self.standard.features[name]
                # the plan keeps away from the stem, the erroneous machine may come closer
                if isinstance(surface, DatumSphere):
                    inside = surface.is_bare(self.uv)
                else:
                    inside = surface.contains(self.uv)
                failures.append(((self.feature == name) & ~inside, Meeting.EDGE))
        for failed, meeting in failures:
            self.meeting[self.is_contact & failed] = meeting
        self.travel = np.where(self.is_contact, self.travel, self.distance)
