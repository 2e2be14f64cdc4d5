"""Space for the probe: heights at which nothing stands in the way, and gaps at a touch."""

from dataclasses import dataclass
from itertools import product
from typing import NamedTuple

import numpy as np

from artefact.body import Standard
from artefact.reach import Workshop, clearance_in_workshop, still_frames, table_face
from probe_paths.plan.probe import Probe
from twin.frames import Array, apply, inverse, turn
from twin.machine import Chain, linear_directions, table_to_tool, tip
from twin.record import Labels, Setup

SMALLEST_GAP = 0.5
"""Least gap between the probe and anything solid while it is positioned, mm."""

SMALLEST_STEP = 0.25
"""Of a march along a move, mm."""

_SWING = 25
"""Samples of every axis that turns in a move: all turn, in no order that is known. Half a turn is
cut every 7 degrees, between which nothing within 300 mm of an axis rises by 0.6 mm."""


class SolidHull(NamedTuple):
    """Balls (points with radii) whose hull holds everything solid, table frame.

    What another axis than the innermost one carries stands in it where that axis takes it while
    all between it and the table read zero (`on`).
    """

    points: Array  # (K, 3)
    radii: Array  # (K,)
    on: Labels  # (K,), empty for what moves with the table


def solid_hull(standard: Standard, setup: Setup, workshop: Workshop) -> SolidHull:
    """Corners of base, core and columns, the spheres, and the corners of all other bodies."""
    points = [_box(standard.base.half_size, 0.0, standard.base.thickness)]
    for column in standard.columns.values():
        corners = _box(column.patch.half_size, -column.patch.depth, column.top)
        points.append(apply(column.patch.T_artefact_patch, corners))
    if standard.core is not None:
        points.append(_ring(standard.core.high_radius, standard.core.height))
    solid = np.concatenate(points)
    centres = np.array([s.centre for s in standard.spheres]).reshape(-1, 3)
    on_table = apply(setup.T_table_artefact, np.concatenate([solid, centres]))
    T_table_face = table_face(setup.T_table_artefact)
    bodies = [apply(T_table_face, body.corners()) for body in workshop.solids]
    all_points = np.concatenate([on_table, *bodies])
    radii = np.zeros(len(all_points))
    radii[len(solid) : len(on_table)] = [s.radius for s in standard.spheres]
    carried = [""] * len(on_table)
    for corners, body in zip(bodies, workshop.solids, strict=True):
        carried += [body.on] * len(corners)
    return SolidHull(all_points, radii, np.array(carried))


def _box(half_size: tuple[float, float], low: float, high: float) -> Array:
    x, y = half_size
    return np.array([[a, b, c] for a in (-x, x) for b in (-y, y) for c in (low, high)])


def _ring(radius: float, height: float, sides: int = 32) -> Array:
    angle = np.arange(sides) * (2.0 * np.pi / sides)
    return np.stack(
        [radius * np.cos(angle), radius * np.sin(angle), np.full(sides, height)], axis=-1
    )


def readings_at(chain: Chain, rotary: Array) -> Array:
    """Readings (N, A) with given rotary readings (N, R), rad, and every other axis at zero."""
    q = np.zeros((len(rotary), len(chain.axes)))
    q[:, [chain.axis_index(name) for name in chain.rotary_axes]] = rotary
    return q


def top_height(chain: Chain, rotary: Array, solid: SolidHull, probe: Probe) -> Array:
    """Reading of Z at which the lowest point of the tool is level with the highest obstacle.

    Args:
        rotary: Readings of the rotary axes, shape (V, R), rad.
        solid: What stands on the table, table frame.
        probe: In the spindle.

    Returns:
        Shape (V,), mm.
    """
    q = readings_at(chain, rotary)
    up = linear_directions(chain, q)[:, :, chain.linear_axes.index("Z")]
    highest = np.full(len(q), -np.inf)
    for on, T_still_table in still_frames(solid.on.tolist(), chain, q).items():
        mine, T_table_still = solid.on == on, inverse(T_still_table)
        along = np.einsum("vji,vj->vi", T_table_still[:, :3, :3], up)
        shift = np.einsum("vi,vi->v", up, T_table_still[:, :3, 3])
        most = (along @ solid.points[mine].T + solid.radii[mine]).max(axis=1)
        highest = np.maximum(highest, most + shift)
    outline = turn(table_to_tool(chain, q)[:, None], probe.outline())  # (V, M, 3)
    below = np.einsum("vmi,vi->vm", outline, up).min(axis=1)
    below = np.minimum(below, -probe.radius)
    level: Array = highest - below - np.einsum("vi,vi->v", up, tip(chain, q, probe.length))
    return level


def swing_height(chain: Chain, path: Array, solid: SolidHull, probe: Probe) -> Array:
    """Highest `top_height` along a path of the rotary axes, whichever turns first; from above.

    Between two samples that are d apart a point at a distance r from an axis rises above both by
    r d^2 / 8 at most, which is added.

    Args:
        path: Rotary readings in order, shape (W, R), rad.
        solid: What stands on the table, table frame.
        probe: In the spindle.

    Returns:
        Of each of the W - 1 moves, mm.
    """
    turn_by = np.diff(path, axis=0)
    rise = ((turn_by / (_SWING - 1)) ** 2 @ _arms(chain, solid, probe)) / 8.0
    shares = np.linspace(0.0, 1.0, _SWING)
    known: dict[bytes, float] = {}  # a return rises as high as the way there
    for i, ends in enumerate(np.sort(np.stack([path[:-1], path[1:]], axis=1), axis=1)):
        if ends.tobytes() not in known:
            # an axis that stands still needs one sample
            samples = [a + shares * (b - a) if b > a else [a] for a, b in ends.T]
            between = np.array(list(product(*samples)))
            height = top_height(chain, between, solid, probe).max(initial=-np.inf)
            known[ends.tobytes()] = float(height)
        rise[i] += known[ends.tobytes()]
    return rise


def _arms(chain: Chain, solid: SolidHull, probe: Probe) -> Array:
    """How far anything that a rotary axis carries is from its axis at most, (R,), mm."""
    on_table = float((np.linalg.norm(solid.points, axis=1) + solid.radii).max())
    tool = float(np.linalg.norm(probe.outline(), axis=1).max())
    arms = []
    for name in chain.rotary_axes:
        link = chain.link(name)
        origin = chain.table_origin if link.carries_workpiece else np.zeros(3)
        carried = on_table if link.carries_workpiece else tool + probe.length
        arms.append(carried + float(np.linalg.norm(link.point - origin)))
    return np.array(arms)


@dataclass(frozen=True, eq=False)
class ToolClearance:
    """How near stylus, body and spindle come to anything solid at single readings.

    Attributes:
        setup: Where it is believed to stand.
        probe: In the spindle.
        workshop: What stands there beside it.
    """

    chain: Chain
    standard: Standard
    setup: Setup
    probe: Probe
    workshop: Workshop

    def gap(self, q: Array) -> tuple[Array, Labels]:
        """Gap between the probe above its ball and anything solid at readings (N, A).

        Returns:
            Smallest gap (N,), mm, and the name of what is nearest (N,).
        """
        near = clearance_in_workshop(
            self.standard,
            self.setup.T_table_artefact,
            table_to_tool(self.chain, q),
            tip(self.chain, q, self.probe.length),
            self.probe.shape,
            self.workshop,
            still_frames(self.workshop.on, self.chain, q),
        )
        return near.distance, near.body

    def swept_gap(self, before: Array, after: Array) -> tuple[Array, Labels]:
        """Smallest gap of the tool above its ball along straight moves of the linear axes.

        The gap of a body that is shifted shrinks no faster than it moves, so each march goes on by
        the gap that it finds, and ends where less than `SMALLEST_GAP` is left.

        Args:
            before: Readings at the beginning, (M, A).
            after: Readings at the end, (M, A).

        Returns:
            The gap (M,), mm, from below, and the name of what is nearest (M,).
        """
        way = after - before
        length = np.linalg.norm(way, axis=1)
        # a way down and the same way up again count once
        leading = np.take_along_axis(way, np.argmax(np.abs(way), axis=1)[:, None], axis=1)
        low, high = np.where(leading < 0.0, after, before), np.where(leading < 0.0, before, after)
        ends = np.round(np.concatenate([low, high], axis=1), 6)
        _, first, same = np.unique(ends, axis=0, return_index=True, return_inverse=True)
        smallest, nearest = np.full(len(first), np.inf), np.full(len(first), "", dtype="U32")
        travel, active = np.zeros(len(first)), np.arange(len(first))
        while len(active):
            rows = first[active]
            share = np.minimum(travel[active] / np.maximum(length[rows], 1e-12), 1.0)
            gap, body = self.gap(before[rows] + share[:, None] * way[rows])
            closer = gap < smallest[active]
            smallest[active[closer]], nearest[active[closer]] = gap[closer], body[closer]
            travel[active] += np.maximum(gap - SMALLEST_GAP, SMALLEST_STEP)
            active = active[(share < 1.0) & (gap >= SMALLEST_GAP)]
        return smallest[same.reshape(-1)], nearest[same.reshape(-1)]
