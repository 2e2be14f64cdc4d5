"""Gaps between the tool and everything solid, at a touch and along a move.

Each cylinder of the tool sweeps a convex body along a straight move, whose gap from the hull of
every obstacle is found directly (`separation`). Where a hull is near, its parts decide.
"""

from dataclasses import dataclass
from enum import StrEnum
from functools import cached_property

import numpy as np

from matstd.artefact.body import Standard
from matstd.artefact.reach import Workshop, still_frames
from matstd.artefact.tool import Probe
from matstd.probe_paths.plan.bodies import Bodies, standing_bodies
from matstd.probe_paths.plan.separation import Hulls, Sweeps, balls_apart, gaps, least_gaps
from matstd.twin.frames import Array, IntArray, Mask, apply, turn
from matstd.twin.machine import Chain, table_to_tool, tip
from matstd.twin.record import Labels, Setup

SMALLEST_GAP = 0.5  # least gap between the probe and any obstacle while it is positioned, mm
_MOVES_A_BLOCK = 200  # moves per block, to bound memory: each meets every body with every piece


@dataclass(frozen=True, eq=False)
class ToolClearance:
    """Gaps between ball, stylus, body and spindle and everything solid."""

    chain: Chain
    standard: Standard
    setup: Setup
    probe: Probe
    workshop: Workshop

    @cached_property
    def bodies(self) -> Bodies:
        """Everything solid, table frame."""
        return standing_bodies(self.standard, self.setup.T_table_artefact, self.workshop)

    @cached_property
    def _tool(self) -> Array:
        """Start, end, radius and ball of every piece of the tool, (P, 4), mm; the ball first."""
        ball = self.probe.radius
        ends = [end for end, _ in self.probe.shape.cylinders]
        radii = [radius for _, radius in self.probe.shape.cylinders]
        # below this height the stylus is hidden in the ball
        begin = float(np.sqrt(ball**2 - min(radii[0], ball) ** 2))
        rows = [
            (low, high, r, 0.0) for low, high, r in zip([begin, *ends], ends, radii, strict=False)
        ]
        return np.array([(0.0, 0.0, 0.0, ball), *rows])

    def gap(self, q: Array) -> tuple[Array, Labels]:
        """Gap (N,), mm, of the tool above its ball at readings (N, A), and the nearest body."""
        return self.swept_gap(q, q, with_ball=False, enough=np.inf)

    def swept_gap(
        self,
        before: Array,
        after: Array,
        with_ball: bool = True,
        with_tool: bool = True,
        spared: Mask | None = None,
        enough: float = SMALLEST_GAP,
    ) -> tuple[Array, Labels]:
        """Smallest gap (M,), mm, of the tool along straight linear moves, and the nearest body.

        Args:
            before: Readings at the beginning, (M, A).
            after: Readings at the end, (M, A).
            spared: Bodies that a move is meant to come near to, (M, B).
            enough: A gap that is larger need not be known better than that, mm.
        """
        tool = self._tool[0 if with_ball else 1 : None if with_tool else 1]
        bodies = self.bodies
        best = np.full((len(before), len(bodies.name)), np.inf)
        frames = [still_frames(bodies.on.tolist(), self.chain, q) for q in (before, after)]
        T_table_tool = table_to_tool(self.chain, before)
        # bodies on one axis stand still in its frame
        for on in frames[0]:
            T = frames[0][on]
            begin, end = (
                apply(frame[on], tip(self.chain, q, self.probe.length))
                for frame, q in zip(frames, (before, after), strict=True)
            )
            axis = turn(T, T_table_tool[:, :3, 2])
            rows = np.flatnonzero(bodies.on == on)
            for some in np.array_split(np.arange(len(begin)), len(begin) // _MOVES_A_BLOCK + 1):
                place = (begin[some], axis[some], (end - begin)[some])
                skip = None if spared is None else spared[np.ix_(some, rows)]
                limit = np.minimum(best[some].min(axis=1), enough)
                best[np.ix_(some, rows)] = _gaps_to(bodies, rows, place, tool, skip, limit)
        nearest = np.argmin(best, axis=1)
        return best[np.arange(len(best)), nearest], bodies.name[nearest]


def _gaps_to(
    bodies: Bodies,
    rows: IntArray,
    place: tuple[Array, Array, Array],
    tool: Array,
    spared: Mask | None,
    enough: Array,
) -> Array:
    """Gaps of M moves from some bodies, over all pieces of the tool, (M, rows), mm."""
    centre, axis, way = place
    move, piece, body = (i.ravel() for i in np.indices((len(centre), len(tool), len(rows))))
    if spared is not None:
        keep = ~spared[move, body]
        move, piece, body = move[keep], piece[keep], body[keep]
    of = rows[body]
    low, high, radius, ball = tool[piece].T
    sweeps = Sweeps(
        centre=centre[move],
        axis=axis[move],
        way=way[move],
        low=low,
        high=high,
        radius=radius,
        ball=ball,
    )

    def search(some: IntArray, limit: Array) -> Array:
        gap = gaps(sweeps[some], bodies.hulls[of[some]], limit)
        for i in bodies.parts:
            near = np.flatnonzero((of[some] == i) & (gap < limit))
            gap[near] = _least_to_parts(bodies.parts[i], sweeps[some[near]], limit[near])
        return gap

    # the gap of enclosing balls is cheap and never too large: most pairs need no exact one
    gap = least_gaps(balls_apart(sweeps, bodies.hulls[of]), move, enough[move], search)
    best = np.full((len(centre), len(rows)), np.inf)
    np.minimum.at(best, (move, body), gap)
    return best


def _least_to_parts(parts: Hulls, sweeps: Sweeps, enough: Array) -> Array:
    """Gap of each sweep from the nearest of the parts of one body, (M,), mm."""
    each = np.repeat(np.arange(len(sweeps)), len(parts))
    part = np.tile(np.arange(len(parts)), len(sweeps))

    def search(some: IntArray, limit: Array) -> Array:
        return gaps(sweeps[each[some]], parts[part[some]], limit)

    gap = least_gaps(balls_apart(sweeps[each], parts[part]), each, enough[each], search)
    return gap.reshape(len(sweeps), len(parts)).min(axis=1)


class Stage(StrEnum):
    """Part of a touch in which the tool may come too near to something."""

    WAY_IN = "on its way in"
    TOUCH = "at the touch"
    OVER_TRAVEL = "where it goes on if the surface is not met"
    RETRACT = "on its way up after a miss"

    def least_gap(self, radius: float) -> float:
        """Gap that a ball of a radius needs, mm: beside what it touches its stylus has a third."""
        return min(SMALLEST_GAP, radius / 3.0) if self is Stage.TOUCH else SMALLEST_GAP


def stroke_gaps(
    clearance: ToolClearance,
    start: Array,
    direction: Array,
    back: Array,
    distance: Array,
    feature: Labels,
    enough: float,
) -> dict[Stage, tuple[Array, Labels]]:
    """Smallest gaps in the parts of N touches, with what is nearest.

    To the expected contact the tool above its ball keeps clear of everything, and the ball of all
    but the touched feature. Beyond it, and on the way up after a miss, both keep clear of all but
    the feature and the core, from which the columns of the faces rise.

    Args:
        start: Readings at the start, (N, A).
        direction: Direction of the motion in readings, unit vectors, (N, A).
        back: Distance to the expected contact, (N,), mm.
        distance: Longest travel, (N,), mm.
    """
    bodies = clearance.bodies
    own = np.zeros((len(start), len(bodies.name)), dtype=bool)
    for name in dict.fromkeys(feature.tolist()):
        own[np.ix_(np.flatnonzero(feature == name), bodies.rows_of(name))] = True
    # beyond the contact the core is spared, as columns come out of it
    core = np.broadcast_to(bodies.name == "CORE", own.shape)
    contact = start + back[:, None] * direction
    end = start + distance[:, None] * direction
    above = end.copy()
    z = clearance.chain.axis_index("Z")
    above[:, z] = np.maximum(end[:, z], clearance.chain.link("Z").range[1])
    tool = clearance.swept_gap(start, contact, with_ball=False, enough=enough)
    ball = clearance.swept_gap(start, contact, with_tool=False, spared=own & ~core, enough=enough)
    beyond = clearance.swept_gap(start, end, spared=own | core, enough=enough)
    up = clearance.swept_gap(end, above, spared=own | core, enough=enough)
    return {Stage.TOUCH: tool, Stage.WAY_IN: ball, Stage.OVER_TRAVEL: beyond, Stage.RETRACT: up}
