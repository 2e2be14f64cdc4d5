"""Alternative approaches to a touch, inclined to the surface normal.

The contact and the measured deviation along the normal stay the same. Only the start of the touch
and the path beyond a missed surface change.
"""

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np

from matstd.artefact.body import Meeting, contact
from matstd.probe_paths.plan.clearance import ToolClearance
from matstd.twin.frames import Array, Mask, apply, inverse, turn, unit
from matstd.twin.machine import linear_directions, table_to_tool, tip
from matstd.twin.record import Labels
from matstd.twin.units import DEG

_LEANS = (15.0 * DEG, 30.0 * DEG)
"""From the normal, rad; beyond 30 degrees the ball slides where it should trigger."""

_SIDES = (0.0, 90.0 * DEG, -90.0 * DEG, 180.0 * DEG)
"""Sides to which an approach is inclined, from that of the spindle, rad."""

_ROUNDING = 9  # decimals: a motion that is nothing but the rounding of one has no sign


@dataclass(frozen=True, eq=False)
class Approaches:
    """Ways to N touches of one table pose each."""

    clearance: ToolClearance  # machine, standard, set-up and probe
    contact: Array  # readings at the expected contact, (N, A)
    normal: Array  # outward unit normals, artefact frame, (N, 3)
    feature: Labels
    back: float  # from the contact to the start, mm
    beyond: float  # from the contact to the end of the longest travel, mm

    def others(self) -> Iterator[tuple[Array, Array, Mask]]:
        """Starts (N, A), motions of X Y Z (N, A) and which are possible, the least leaning first.

        A way is possible if it stays within travel, meets its feature first, and moves X, Y and Z
        in the senses of the normal: the evaluation of a log takes the sides of all reversals from
        the normal.
        """
        place = self.clearance.setup.T_table_artefact
        normal = turn(place, self.normal)
        tool = table_to_tool(self.clearance.chain, self.contact)[:, :3, 2]
        towards = tool - np.einsum("ni,ni->n", tool, normal)[:, None] * normal
        size = np.linalg.norm(towards, axis=1, keepdims=True)
        any_side = np.cross(normal, np.eye(3)[np.argmin(np.abs(normal), axis=1)])
        towards = unit(np.where(size > 1e-6, towards, any_side))
        across = np.cross(normal, towards)
        for lean in _LEANS:
            for side in _SIDES:
                beside = np.cos(side) * towards + np.sin(side) * across
                yield self._along(np.cos(lean) * normal + np.sin(lean) * beside, normal)

    def _along(self, away: Array, normal: Array) -> tuple[Array, Array, Mask]:
        """Ways along given directions in the table frame."""
        chain, probe = self.clearance.chain, self.clearance.probe
        columns = chain.linear_columns
        per_axis = np.linalg.inv(linear_directions(chain, self.contact))
        motion = np.zeros(self.contact.shape)
        motion[:, columns] = -np.einsum("nij,nj->ni", per_axis, away)
        usual = -np.einsum("nij,nj->ni", per_axis, normal)
        start = self.contact - self.back * motion
        ends = np.stack([start, self.contact + self.beyond * motion])[..., columns]
        low, high = chain.travels[columns].T
        here, there = (np.sign(np.round(v, _ROUNDING)) for v in (motion[:, columns], usual))
        T_artefact_table = inverse(self.clearance.setup.T_table_artefact)
        met = contact(
            self.clearance.standard,
            apply(T_artefact_table, tip(chain, start, probe.length)),
            turn(T_artefact_table, -away),
            probe.radius,
            np.full(len(start), self.back + self.beyond),
        )
        is_met = (met.meeting == Meeting.SURFACE) & (met.feature == self.feature)
        is_within = ((ends >= low) & (ends <= high)).all(axis=(0, 2))
        return start, motion, is_met & (here == there).all(axis=1) & is_within
