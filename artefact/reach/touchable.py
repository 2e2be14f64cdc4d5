"""Which touches a machine can make on a standard: angle, travel, room for the probe, free ways.

The choice of touches and the plan both ask here; they differ only in their margins.
"""

from collections import Counter
from dataclasses import dataclass, field, fields

import numpy as np

from matstd.artefact.body import Meeting, Standard, contact
from matstd.artefact.reach.face_of_table import table_face
from matstd.artefact.reach.probe_clearance import Clearance, ProbeShape, clearance
from matstd.artefact.reach.workshop import Workshop, still_frames
from matstd.twin.frames import Array, IntArray, Mask, apply, inverse, turn
from matstd.twin.machine import (
    Chain,
    inverse_linear,
    linear_directions,
    table_to_tool,
    tool_and_directions,
)
from matstd.twin.numbers import distinct_rows
from matstd.twin.record import Labels, Setup, Touches, linear_approach
from matstd.twin.units import DEG

_WORDS = "U200"  # of a reason
_START_HEIGHT = 400.0  # mm the ball comes down from, far above any standard
_DESCENT_MARGIN = 1.0  # mm added to the ball on its way down
TRAVEL_ROUNDING = 1e-9
"""mm or rad: a reading at the very end of a travel is inside, whatever its last digit."""


@dataclass(frozen=True, eq=False)
class Requests:
    """Wanted touches, in any order."""

    feature: Labels  # names of features, (N,)
    point: Array  # contact points, artefact frame, (N, 3), mm
    normal: Array  # outward unit normals there, (N, 3)
    rotary: Array  # readings of the rotary axes in chain order, (N, R), rad

    def __len__(self) -> int:
        return len(self.point)

    def __getitem__(self, rows: Mask | IntArray | slice) -> "Requests":
        return Requests(*(getattr(self, f.name)[rows] for f in fields(self)))

    @property
    def pose(self) -> IntArray:
        """Number of the table pose of every touch, (N,), from 0 in the order of the readings."""
        return np.unique(np.round(self.rotary, 9), axis=0, return_inverse=True)[1].ravel()


def joined(parts: list[Requests]) -> Requests:
    """Several lots of touches as one."""
    return Requests(
        *(np.concatenate([getattr(p, f.name) for p in parts]) for f in fields(Requests))
    )


@dataclass(frozen=True, eq=False)
class ProbeReach:
    """Machine, probe and place of the standard, with the room that a touch is given."""

    chain: Chain
    setup: Setup
    shape: ProbeShape
    length: float  # gauge point to ball centre, mm
    steepest: float = 75.0 * DEG  # largest angle between a surface's normal and the tool axis, rad
    room: float = 2.0  # smallest gap between the probe above its ball and anything solid, mm
    standoff: float = 5.0  # gap between ball and surface at the start of a touch, mm
    search: float = 3.0  # how far beyond the expected contact the travel must reach, mm
    workshop: Workshop = field(default_factory=Workshop)

    @property
    def radius(self) -> float:
        """Of the ball, mm."""
        return self.shape.ball_radius

    @property
    def table_radius(self) -> float:
        """Of the largest disc that the table's face holds, mm."""
        return self.workshop.table_radius

    def readings(self, wanted: Requests, gap: float = 0.0) -> Array:
        """Axis readings with the ball this far off the surface along the normal, (N, A).

        At fixed rotary readings the tip is an affine function of the linear ones, so kinematics is
        done once a table pose and not once a touch.

        Raises:
            NotReachable: The machine has not three independent linear axes at some pose.
        """
        return self._readings(wanted, gap, self._pose_kinematics(wanted))

    def _readings(self, wanted: Requests, gap: float, poses: "_PoseKinematics") -> Array:
        chain = self.chain
        q = np.zeros((len(wanted), len(chain.axes)))
        q[:, chain.rotary_columns] = wanted.rotary
        ball = wanted.point + (self.radius + gap) * wanted.normal
        target = apply(self.setup.T_table_artefact, ball)
        i = poses.index
        way = (target - poses.tip[i])[..., None]
        linear = chain.linear_columns
        q[:, linear] = poses.q[i][:, linear] + (poses.inverse[i] @ way)[..., 0]
        return q

    def _pose_kinematics(self, wanted: Requests) -> "_PoseKinematics":
        """The table poses of touches, with all that depends on the pose alone."""
        chain = self.chain
        poses, index = distinct_rows(wanted.rotary)
        q = np.zeros((len(poses), len(chain.axes)))
        q[:, chain.rotary_columns] = poses
        target = np.tile(self.setup.T_table_artefact[:3, 3], (len(poses), 1))
        q = inverse_linear(chain, target, q, self.length)
        T_table_tool, along = tool_and_directions(chain, q)
        unit = np.broadcast_to(np.eye(3), along.shape)
        return _PoseKinematics(
            index=index,
            q=q,
            tip=target,
            inverse=np.asarray(np.linalg.solve(along, unit), dtype=np.float64),
            T_table_tool=T_table_tool,
            along=along,
        )

    def everywhere(
        self, point: Array, normal: Array, poses: Array, gap: float = 0.0
    ) -> tuple[Array, Array]:
        """Every one of N places (N, 3) at every one of K table poses (K, R).

        Returns:
            Readings of the linear axes as of `readings`, (N, K, 3), and the angle between normal
            and tool axis, (N, K), rad.
        """
        k = len(poses)
        nowhere = np.zeros((k, 3))
        at = self._pose_kinematics(Requests(np.full(k, ""), nowhere, nowhere, poses))
        i, place = at.index, self.setup.T_table_artefact
        linear = self.chain.linear_columns
        target = apply(place, point + (self.radius + gap) * normal)
        way = target[:, None] - at.tip[i]
        q = at.q[i][:, linear] + np.einsum("kij,nkj->nki", at.inverse[i], way)
        cosine = turn(place, normal) @ at.T_table_tool[i, :3, 2].T
        return q, np.arccos(np.clip(cosine, -1.0, 1.0))

    def touches(self, wanted: Requests) -> Touches:
        """The touches as a record that effects understand."""
        n, q = len(wanted), self.readings(wanted)
        normal_table = turn(self.setup.T_table_artefact, wanted.normal)
        return Touches(
            chain=self.chain,
            q=q,
            length=np.full(n, self.length),
            radius=np.full(n, self.radius),
            point=wanted.point,
            normal=wanted.normal,
            setups=(self.setup,),
            setup=np.zeros(n, dtype=np.int64),
            time=np.zeros(n),
            approach=linear_approach(self.chain, q, normal_table),
            feature=wanted.feature,
            pose=wanted.pose,
        )

    def is_reachable(self, wanted: Requests) -> Mask:
        """Touches within the angle to the tool axis and within every travel, (N,)."""
        poses = self._pose_kinematics(wanted)
        good: Mask = self._cosine(wanted, poses) >= np.cos(self.steepest)
        for gap in self.gaps:
            good &= (self._excess(self._readings(wanted, gap, poses)) == 0.0).all(axis=1)
        return good

    def is_clear(self, standard: Standard, wanted: Requests) -> Mask:
        """Touches with room for the probe, a free way down and nothing in front of them, (N,)."""
        return self._obstructions(standard, wanted) == ""

    def has_room(self, standard: Standard, wanted: Requests, is_near_lid: bool = False) -> Mask:
        """Touches at which nothing comes near the probe above its ball, (N,).

        Args:
            is_near_lid: As of `clearance`: for scans, which go wherever a face can be followed.
        """
        return self._room(standard, wanted, 0.0, is_near_lid).distance >= self.room

    def against(self, standard: Standard, wanted: Requests) -> str:
        """What is against touches none of which has room, or that are none, in words."""
        if not len(wanted):
            angle = self.steepest / DEG
            return f"none is within {angle:g} degrees of the tool axis and within every travel"
        near = self._room(standard, wanted, 0.0)
        name, count = Counter(near.body.tolist()).most_common(1)[0]
        return (
            f"the probe comes nearer than {self.room:g} mm to {name} at "
            f"{100.0 * count / len(wanted):.0f} % of those within its angle and travels; nearest "
            f"miss {self.room - float(near.distance.max()):.2f} mm"
        )

    def reasons(self, standard: Standard, wanted: Requests) -> Labels:
        """The first thing that is against each touch, in words; empty where nothing is, (N,)."""
        reason = np.full(len(wanted), "", dtype=_WORDS)
        good = self.is_reachable(wanted)
        bad = np.flatnonzero(~good)
        reason[bad] = [self._out_of_reach(wanted[bad[i : i + 1]]) for i in range(len(bad))]
        rows = np.flatnonzero(good)
        reason[rows] = self._obstructions(standard, wanted[rows])
        return reason

    @property
    def gaps(self) -> tuple[float, float, float]:
        """Between ball and surface at the start of a touch, at the contact, at the search's end."""
        return (self.standoff, 0.0, -self.search)

    def _cosine(self, wanted: Requests, poses: "_PoseKinematics") -> Array:
        """Cosine of the angle between normal and tool axis, (N,)."""
        axis = poses.T_table_tool[poses.index, :3, 2]
        return np.einsum("ni,ni->n", axis, turn(self.setup.T_table_artefact, wanted.normal))

    def _excess(self, q: Array) -> Array:
        """How far readings (N, A) are beyond the ends of their travels, (N, A), mm and rad."""
        low, high = np.array([self.chain.link(name).range for name in self.chain.axes]).T
        return np.maximum(np.maximum(low - q, q - high) - TRAVEL_ROUNDING, 0.0)

    def _out_of_reach(self, one: Requests) -> str:
        """Why one touch is not within angle and travels."""
        cosine = float(self._cosine(one, self._pose_kinematics(one))[0])
        if cosine < np.cos(self.steepest):
            angle = np.arccos(max(cosine, -1.0)) / DEG
            return f"the surface leans {angle:.1f} degrees from the tool axis"
        for gap in self.gaps:
            q = self.readings(one, gap)
            for i in np.flatnonzero(self._excess(q)[0]):
                link = self.chain.link(self.chain.axes[i])
                unit, word = (1.0, "mm") if link.kind == "linear" else (DEG, "degrees")
                value, low, high = q[0, i] / unit, link.range[0] / unit, link.range[1] / unit
                return f"{link.name} would have to go to {value:.1f}, {low:g} to {high:g} {word}"
        return ""

    def _obstructions(self, standard: Standard, wanted: Requests) -> Labels:
        """What is in the way of probe and ball, cheapest look first; empty where nothing, (N,)."""
        reason = np.full(len(wanted), "", dtype=_WORDS)
        for look in (self._tight, self._tight_at_start, self._way_down, self._way_in):
            rows = np.flatnonzero(reason == "")
            reason[rows] = look(standard, wanted[rows])
        return reason

    def _tight(self, standard: Standard, wanted: Requests, gap: float = 0.0) -> Labels:
        near = self._room(standard, wanted, gap)
        words = [
            f"{g:.2f} mm between probe and {b}" if g < self.room else ""
            for g, b in zip(near.distance.tolist(), near.body.tolist(), strict=True)
        ]
        return np.array(words, dtype=_WORDS)

    def _tight_at_start(self, standard: Standard, wanted: Requests) -> Labels:
        return self._tight(standard, wanted, self.standoff)

    def _room(
        self, standard: Standard, wanted: Requests, gap: float, is_near_lid: bool = False
    ) -> Clearance:
        """How near the probe comes to the standard and to everything round it; from below.

        The ball itself is looked at against all but the standard, which it is meant to touch.
        """
        poses, place, probe = self._pose_kinematics(wanted), self.setup.T_table_artefact, self.shape
        T_table_tool = poses.T_table_tool[poses.index]
        centre = apply(place, wanted.point + (self.radius + gap) * wanted.normal)
        at, axis = apply(inverse(place), centre), turn(inverse(place), T_table_tool[:, :3, 2])
        near = clearance(standard, at, axis, probe, self.room, is_near_lid)
        room, body = near.distance, near.body.astype("U32")
        still = still_frames(self.workshop.on, self.chain, poses.q)
        for solid in self.workshop.solids:
            T = inverse(table_face(place) @ solid.T_face_solid) @ still[solid.on][poses.index]
            of_probe = np.full(len(centre), -np.inf)
            for places, radii in (probe.rough_cover(), probe.fine_cover()):
                tight = np.flatnonzero(of_probe < self.room)
                balls = centre[tight, None] + turn(T_table_tool[tight, None], places)
                balls = apply(T[tight, None], balls).reshape(-1, 3)
                each = solid.plate.distance(balls).reshape(len(tight), len(radii)) - radii
                of_probe[tight] = np.maximum(of_probe[tight], each.min(axis=1, initial=np.inf))
            of_ball = solid.plate.distance(apply(T, centre)) - probe.ball_radius
            nearest = np.minimum(of_probe, of_ball)
            nearer = nearest < room
            room, body = np.where(nearer, nearest, room), np.where(nearer, solid.name, body)
        return Clearance(room, body)

    def _way_down(self, standard: Standard, wanted: Requests) -> Labels:
        """What the ball meets on its way down to the start."""
        up = turn(inverse(self.setup.T_table_artefact), self._retreat(wanted))
        start = wanted.point + (self.radius + self.standoff) * wanted.normal
        met = contact(
            standard, start + _START_HEIGHT * up, -up, self.radius + _DESCENT_MARGIN, _START_HEIGHT
        )
        words = [
            f"on its way down the ball {_met(what, name)}" if what != Meeting.NOTHING else ""
            for what, name in zip(met.meeting, met.feature, strict=True)
        ]
        return np.array(words, dtype=_WORDS)

    def _way_in(self, standard: Standard, wanted: Requests) -> Labels:
        """What the ball meets on its way in before the wanted feature, or instead of it."""
        start = wanted.point + (self.radius + self.standoff) * wanted.normal
        met = contact(standard, start, -wanted.normal, self.radius, self.standoff + self.search)
        good = met.is_surface & (met.feature == wanted.feature)
        words = [
            "" if is_good else f"the ball {_met(what, name)}"
            for is_good, what, name in zip(good, met.meeting, met.feature, strict=True)
        ]
        return np.array(words, dtype=_WORDS)

    def _retreat(self, wanted: Requests) -> Array:
        """Direction in which the tool withdraws, table frame, (N, 3).

        The linear axis that runs most nearly along the tool with every axis at zero, as programs
        do: they lift Z, whatever way a tilting head looks.
        """
        chain = self.chain
        zero = np.zeros((1, len(chain.axes)))
        along = linear_directions(chain, zero)[0].T @ table_to_tool(chain, zero)[0, :3, 2]
        best = int(np.argmax(np.abs(along)))
        poses = self._pose_kinematics(wanted)
        return np.sign(along[best]) * poses.along[poses.index, :, best]


def _met(what: Meeting, name: str) -> str:
    return f"{what} of {name}" if name else str(what)


@dataclass(frozen=True, eq=False)
class _PoseKinematics:
    """K table poses that N touches are made at."""

    index: IntArray  # pose of every touch, (N,)
    q: Array  # readings that bring the tip to one point, (K, A)
    tip: Array  # that point, table frame, (K, 3), mm
    inverse: Array  # linear readings per motion of the tip, (K, 3, 3)
    T_table_tool: Array  # pose of the tool, of which only the rotation depends on the pose alone
    along: Array  # motion of the tip per unit of each linear axis, (K, 3, 3)
