"""Gaps between the tool and everything solid, at a touch and along a move.

Each cylinder of the tool sweeps a convex body along a straight move, whose gap from the hull of
every obstacle is found directly (`separation`). Where a hull is near, its parts decide.
"""

from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from matstd.artefact.body import Standard
from matstd.artefact.reach import Workshop, still_frames
from matstd.artefact.tool import Probe
from matstd.probe_paths.plan.bodies import Bodies, standing_bodies
from matstd.probe_paths.plan.separation import Hulls, Sweeps, balls_apart, gaps, least_gaps
from matstd.twin.frames import Array, apply, turn
from matstd.twin.machine import Chain, table_to_tool, tip
from matstd.twin.record import IntArray, Labels, Setup

SMALLEST_GAP = 0.5
"""Least gap between the probe and any obstacle while it is positioned, mm."""

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
        spared: NDArray[np.bool_] | None = None,
        enough: float = SMALLEST_GAP,
    ) -> tuple[Array, Labels]:
        """Smallest gap (M,), mm, of the tool along straight linear moves, and the nearest body.

        Args:
            before: Readings at the beginning, (M, A).
            after: Readings at the end, (M, A).
            with_tool: Whether what is above the ball is.
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
    spared: NDArray[np.bool_] | None,
    enough: Array,
) -> Array:
    """Gaps of M moves from some bodies, over all pieces of the tool, (M, rows), mm.

    Args:
        enough: A least gap of a move that is larger need not be known better than that, (M,), mm.
    """
    move, piece, body = (i.reshape(-1) for i in np.indices((len(place[0]), len(tool), len(rows))))
    if spared is not None:
        keep = ~spared[move, body]
        move, piece, body = move[keep], piece[keep], body[keep]
    of = rows[body]

    def search(some: IntArray, limit: Array) -> Array:
        sweeps = _sweeps(place, tool, move[some], piece[some])
        gap = gaps(sweeps, bodies.hulls[of[some]], limit)
        for i in bodies.parts:
            near = np.flatnonzero((of[some] == i) & (gap < limit))
            gap[near] = _least_to_parts(bodies.parts[i], sweeps[near], limit[near])
        return gap

    # the gap of enclosing balls is cheap and never too large: most pairs need no exact one
    bound = balls_apart(_sweeps(place, tool, move, piece), bodies.hulls[of])
    gap = least_gaps(bound, move, enough[move], search)
    best = np.full((len(place[0]), len(rows)), np.inf)
    np.minimum.at(best, (move, body), gap)
    return best


def _least_to_parts(parts: Hulls, sweeps: Sweeps, enough: Array) -> Array:
    """Gap of each sweep from the nearest of the parts of one body, (M,), mm."""
    each = np.repeat(np.arange(len(sweeps)), len(parts))
    part = np.tile(np.arange(len(parts)), len(sweeps))

    def search(some: IntArray, limit: Array) -> Array:
        return gaps(sweeps[each[some]], parts[part[some]], limit)

    bound = balls_apart(sweeps[each], parts[part])
    gap = least_gaps(bound, each, enough[each], search)
    return np.asarray(gap.reshape(len(sweeps), len(parts)).min(axis=1))


def _sweeps(
    place: tuple[Array, Array, Array], tool: Array, move: IntArray, piece: IntArray
) -> Sweeps:
    centre, axis, way = place
    low, high, radius, ball = tool[piece].T
    return Sweeps(
        centre=centre[move],
        axis=axis[move],
        way=way[move],
        low=low,
        high=high,
        radius=radius,
        ball=ball,
    )
