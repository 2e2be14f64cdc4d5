"""Which touches a machine can make on a standard: angle, travel, room for the probe."""

from dataclasses import dataclass, fields

import numpy as np
from numpy.typing import NDArray

from artefact.body import Plate
from artefact.clearance import ProbeShape
from artefact.patch import Meeting
from artefact.standard import Standard
from twin.chain import Chain
from twin.frames import Array, apply, inverse, turn
from twin.kinematics import inverse_linear, linear_directions, table_to_tool, tip
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
        """Axis readings with the ball this far off the surface along the normal, (N, A)."""
        chain = self.chain
        q = np.zeros((len(wanted), len(chain.axes)))
        q[:, [chain.axis_index(name) for name in chain.rotary_axes]] = wanted.rotary
        ball = wanted.point + (self.radius + gap) * wanted.normal
        return inverse_linear(chain, apply(self.setup.T_table_artefact, ball), q, self.length)

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
        contact = self.readings(wanted)
        axis = table_to_tool(self.chain, contact)[:, :3, 2]
        n = turn(self.setup.T_table_artefact, wanted.normal)
        good: Mask = np.einsum("ni,ni->n", axis, n) >= np.cos(self.steepest)
        for q in (
            contact,
            self.readings(wanted, self.standoff),
            self.readings(wanted, -self.search),
        ):
            for i, name in enumerate(self.chain.axes):
                low, high = self.chain.link(name).range
                good &= (q[:, i] >= low) & (q[:, i] <= high)
        return good

    def is_clear(self, standard: Standard, wanted: Requests) -> Mask:
        """Touches with room for the probe, a free way down and nothing in front of them, (N,)."""
        good = np.ones(len(wanted), dtype=bool)
        for check in (self._has_room, self._way_is_free):
            rows = np.flatnonzero(good)
            good[rows] = check(standard, wanted[rows])
        return good

    def _has_room(self, standard: Standard, wanted: Requests) -> Mask:
        T_artefact_table = inverse(self.setup.T_table_artefact)
        good = np.ones(len(wanted), dtype=bool)
        for gap in (0.0, self.standoff):
            rows = np.flatnonzero(good)
            q = self.readings(wanted[rows], gap)
            T_table_tool = table_to_tool(self.chain, q)
            centre = tip(self.chain, q, self.length)
            axis = turn(T_artefact_table, T_table_tool[:, :3, 2])
            above = standard.clearance(apply(T_artefact_table, centre), axis, self.shape)
            good[rows] = (above.distance >= self.room) & self._is_above_table(T_table_tool, centre)
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
        q = self.readings(wanted, self.standoff)
        start = apply(T_artefact_table, tip(self.chain, q, self.length))
        up = turn(T_artefact_table, self._retreat(q))
        down = standard.contact(start + _LIFT * up, -up, self.radius + _WIDER, _LIFT)
        good: Mask = down.meeting == Meeting.NOTHING
        rows = np.flatnonzero(good)
        reach = self.standoff + self.search
        met = standard.contact(start[rows], -wanted.normal[rows], self.radius, reach)
        good[rows] = met.is_surface & (met.feature == wanted.feature[rows])
        return good

    def _retreat(self, q: Array) -> Array:
        """Direction in which the tool withdraws, table frame, (N, 3).

        The linear axis that runs most nearly along the tool with every axis at zero, as programs
        do: they lift Z, whatever way a tilting head looks.
        """
        chain = self.chain
        zero = np.zeros((1, len(chain.axes)))
        along = linear_directions(chain, zero)[0].T @ table_to_tool(chain, zero)[0, :3, 2]
        best = int(np.argmax(np.abs(along)))
        up: Array = np.sign(along[best]) * linear_directions(chain, q)[:, :, best]
        return up
