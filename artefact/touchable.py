"""Which touches a machine can make on a standard: angle, travel, room for the probe."""

from dataclasses import dataclass, fields

import numpy as np
from numpy.typing import NDArray

from artefact.body import Plate
from artefact.clearance import ProbeShape, clearance
from artefact.patch import Meeting
from artefact.standard import Standard
from twin.chain import Chain
from twin.frames import Array, apply, inverse, turn
from twin.kinematics import inverse_linear, linear_directions, table_to_tool
from twin.touches import IntArray, Labels, Setup, Touches, linear_approach
from twin.units import DEG

Mask = NDArray[np.bool_]

_LIFT = 400.0  # mm the ball comes down from, far above any standard
_WIDER = 1.0  # mm added to the ball on its way down


@dataclass(frozen=True, eq=False)
class Requests:
    """Touches that somebody wants, in any order.

    Attributes:
        feature: Names of features, (N,).
        point: Contact points, artefact frame, (N, 3), mm.
        normal: Outward unit normals there, (N, 3).
        rotary: Readings of the rotary axes in chain order, (N, R), rad.
    """

    feature: Labels
    point: Array
    normal: Array
    rotary: Array

    def __len__(self) -> int:
        return len(self.point)

    def __getitem__(self, rows: Mask | IntArray | slice) -> "Requests":
        return Requests(*(getattr(self, f.name)[rows] for f in fields(self)))

    @property
    def pose(self) -> IntArray:
        """Number of the table pose of every touch, (N,), from 0 in the order of the readings."""
        return np.unique(np.round(self.rotary, 9), axis=0, return_inverse=True)[1].reshape(-1)


def joined(parts: list[Requests]) -> Requests:
    """Several lots of touches as one."""
    return Requests(
        *(np.concatenate([getattr(p, f.name) for p in parts]) for f in fields(Requests))
    )


@dataclass(frozen=True, eq=False)
class Probing:
    """Machine, probe and place of the standard, with the room that a touch is given.

    Attributes:
        chain: The machine.
        setup: Where the standard stands.
        shape: The probe from its ball upwards.
        length: Gauge point to ball centre, mm.
        steepest: Largest angle between a surface's normal and the tool axis, rad.
        room: Smallest gap between the probe above its ball and anything solid, mm.
        standoff: Gap between ball and surface at the start of a touch, mm.
        search: How far beyond the expected contact the travel must reach, mm.
        table_radius: Of the table's face, mm.
        table_thickness: Of what is kept clear below it, mm.
    """

    chain: Chain
    setup: Setup
    shape: ProbeShape
    length: float
    steepest: float = 75.0 * DEG
    room: float = 2.0
    standoff: float = 5.0
    search: float = 3.0
    table_radius: float = 160.0
    table_thickness: float = 60.0

    @property
    def radius(self) -> float:
        """Of the ball, mm."""
        return self.shape.ball_radius

    def readings(self, wanted: Requests, gap: float = 0.0) -> Array:
        """Axis readings with the ball this far off the surface along the normal, (N, A).

        At fixed rotary readings the tip is an affine function of the linear ones, so kinematics is
        done once a table pose and not once a touch.

        Raises:
            NotReachable: The machine has not three independent linear axes at some pose.
        """
        chain, stands = self.chain, self._stands(wanted)
        rotary = [chain.axis_index(name) for name in chain.rotary_axes]
        q = np.zeros((len(wanted), len(chain.axes)))
        q[:, rotary] = wanted.rotary
        ball = wanted.point + (self.radius + gap) * wanted.normal
        target = apply(self.setup.T_table_artefact, ball)
        i = stands.index
        way = (target - stands.tip[i])[..., None]
        linear = [chain.axis_index(name) for name in chain.linear_axes]
        q[:, linear] = stands.q[i][:, linear] + (stands.inverse[i] @ way)[..., 0]
        return q

    def _stands(self, wanted: Requests) -> "_Stands":
        """The table poses of touches, with all that depends on the pose alone."""
        chain = self.chain
        poses, index = np.unique(wanted.rotary, axis=0, return_inverse=True)
        q = np.zeros((len(poses), len(chain.axes)))
        q[:, [chain.axis_index(name) for name in chain.rotary_axes]] = poses
        target = np.tile(self.setup.T_table_artefact[:3, 3], (len(poses), 1))
        q = inverse_linear(chain, target, q, self.length)
        along = linear_directions(chain, q)
        unit = np.broadcast_to(np.eye(3), along.shape)
        return _Stands(
            index=index.reshape(-1),
            q=q,
            tip=target,
            inverse=np.asarray(np.linalg.solve(along, unit), dtype=np.float64),
            T_table_tool=table_to_tool(chain, q),
            along=along,
        )

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
        stands = self._stands(wanted)
        axis = stands.T_table_tool[stands.index, :3, 2]
        n = turn(self.setup.T_table_artefact, wanted.normal)
        good: Mask = np.einsum("ni,ni->n", axis, n) >= np.cos(self.steepest)
        for gap in (self.standoff, 0.0, -self.search):
            q = self.readings(wanted, gap)
            for i, name in enumerate(self.chain.axes):
                low, high = self.chain.link(name).range
                good &= (q[:, i] >= low) & (q[:, i] <= high)
        return good

    def is_clear(self, standard: Standard, wanted: Requests) -> Mask:
        """Touches with room for the probe, a free way down and nothing in front of them, (N,)."""
        good = self.has_room(standard, wanted)
        rows = np.flatnonzero(good)
        good[rows] = self.has_room(standard, wanted[rows], self.standoff)
        rows = np.flatnonzero(good)
        good[rows] = self._way_is_free(standard, wanted[rows])
        return good

    def has_room(self, standard: Standard, wanted: Requests, gap: float = 0.0) -> Mask:
        """Touches at which nothing comes near the probe above its ball, (N,).

        Args:
            standard: What is touched.
            wanted: The touches.
            gap: Between ball and surface, mm.
        """
        T_artefact_table = inverse(self.setup.T_table_artefact)
        stands = self._stands(wanted)
        T_table_tool = stands.T_table_tool[stands.index]
        ball = wanted.point + (self.radius + gap) * wanted.normal
        axis = turn(T_artefact_table, T_table_tool[:, :3, 2])
        above = clearance(standard, ball, axis, self.shape, enough=self.room)
        good: Mask = above.distance >= self.room
        rows = np.flatnonzero(good)
        centre = apply(self.setup.T_table_artefact, ball[rows])
        good[rows] = self._is_above_table(T_table_tool[rows], centre)
        return good

    def _is_above_table(self, T_table_tool: Array, centre: Array) -> Mask:
        """Whether ball and probe keep their distance from the table, (N,)."""
        r = self.table_radius
        table = Plate((r, r), r, -self.table_thickness, 0.0)
        good = np.zeros(len(centre), dtype=bool)
        for places, radii in (self.shape.rough_cover(), self.shape.fine_cover()):
            rows = np.flatnonzero(~good)  # a finer cover for those that a rough one refuses
            balls = centre[rows, None] + np.einsum(
                "nij,kj->nki", T_table_tool[rows, :3, :3], places
            )
            gap = table.distance(balls.reshape(-1, 3)).reshape(balls.shape[:2]) - radii
            good[rows] = gap.min(axis=1) >= self.room
        good &= table.distance(centre) - self.radius >= self.room
        return good

    def _way_is_free(self, standard: Standard, wanted: Requests) -> Mask:
        """The ball meets nothing on its way down, and first the wanted feature on its way in."""
        T_artefact_table = inverse(self.setup.T_table_artefact)
        start = wanted.point + (self.radius + self.standoff) * wanted.normal
        up = turn(T_artefact_table, self._retreat(wanted))
        down = standard.contact(start + _LIFT * up, -up, self.radius + _WIDER, _LIFT)
        good: Mask = down.meeting == Meeting.NOTHING
        rows = np.flatnonzero(good)
        reach = self.standoff + self.search
        met = standard.contact(start[rows], -wanted.normal[rows], self.radius, reach)
        good[rows] = met.is_surface & (met.feature == wanted.feature[rows])
        return good

    def _retreat(self, wanted: Requests) -> Array:
        """Direction in which the tool withdraws, table frame, (N, 3).

        The linear axis that runs most nearly along the tool with every axis at zero, as programs
        do: they lift Z, whatever way a tilting head looks.
        """
        chain = self.chain
        zero = np.zeros((1, len(chain.axes)))
        along = linear_directions(chain, zero)[0].T @ table_to_tool(chain, zero)[0, :3, 2]
        best = int(np.argmax(np.abs(along)))
        stands = self._stands(wanted)
        up: Array = np.sign(along[best]) * stands.along[stands.index, :, best]
        return up


@dataclass(frozen=True, eq=False)
class _Stands:
    """K table poses that N touches are made at.

    Attributes:
        index: Pose of every touch, (N,).
        q: Readings that bring the tip to one point, (K, A).
        tip: That point, table frame, (K, 3), mm.
        inverse: Linear readings per motion of the tip, (K, 3, 3).
        T_table_tool: Pose of the tool, of which only the rotation depends on the pose alone.
        along: Motion of the tip per unit of each linear axis, (K, 3, 3).
    """

    index: IntArray
    q: Array
    tip: Array
    inverse: Array
    T_table_tool: Array
    along: Array
