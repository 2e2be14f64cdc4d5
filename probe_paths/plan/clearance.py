"""Space for the probe: heights at which nothing stands in the way, and gaps at a touch."""

from dataclasses import dataclass
from itertools import product
from typing import NamedTuple

import numpy as np

from artefact.body import Plate, Standard
from artefact.reach import TABLE_THICKNESS, clearance_on_table, table_face
from probe_paths.plan.probe import Probe
from twin.frames import Array, apply, turn
from twin.machine import Chain, linear_directions, table_to_tool, tip
from twin.record import Labels, Setup

_SWING = 7
"""Samples of every rotary axis over one move: both axes turn, in no order that is known."""


class SolidHull(NamedTuple):
    """Balls (points with radii) whose hull holds everything solid on the table, table frame."""

    points: Array  # (K, 3)
    radii: Array  # (K,)


def solid_hull(standard: Standard, setup: Setup, table_radius: float) -> SolidHull:
    """Corners of base, core and columns, the spheres, and the rim of the table."""
    points = [_box(standard.base.half_size, 0.0, standard.base.thickness)]
    for column in standard.columns.values():
        corners = _box(column.patch.half_size, -column.patch.depth, column.top)
        points.append(apply(column.patch.T_artefact_patch, corners))
    if standard.core is not None:
        points.append(_ring(standard.core.high_radius, standard.core.height))
    solid = np.concatenate(points)
    centres = np.array([s.centre for s in standard.spheres]).reshape(-1, 3)
    on_table = apply(setup.T_table_artefact, np.concatenate([solid, centres]))
    rim = apply(table_face(setup.T_table_artefact), _ring(table_radius, 0.0))
    radii = np.zeros(len(on_table) + len(rim))
    radii[len(solid) : len(on_table)] = [s.radius for s in standard.spheres]
    return SolidHull(np.concatenate([on_table, rim]), radii)


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
        chain: The machine.
        rotary: Readings of the rotary axes, shape (V, R), rad.
        solid: What stands on the table, table frame.
        probe: In the spindle.

    Returns:
        Shape (V,), mm.
    """
    q = readings_at(chain, rotary)
    up = linear_directions(chain, q)[:, :, chain.linear_axes.index("Z")]
    highest = (up @ solid.points.T + solid.radii).max(axis=1)
    outline = turn(table_to_tool(chain, q)[:, None], probe.outline())  # (V, M, 3)
    below = np.einsum("vmi,vi->vm", outline, up).min(axis=1)
    below = np.minimum(below, -probe.radius)
    level: Array = highest - below - np.einsum("vi,vi->v", up, tip(chain, q, probe.length))
    return level


def swing_height(chain: Chain, path: Array, solid: SolidHull, probe: Probe) -> Array:
    """Highest `top_height` while the rotary axes turn along a path, whichever turns first.

    Args:
        chain: The machine.
        path: Rotary readings in order, shape (W, R), rad.
        solid: What stands on the table, table frame.
        probe: In the spindle.

    Returns:
        Of each of the W - 1 moves, mm.
    """
    axes = path.shape[1]
    share = np.array(list(product(np.linspace(0.0, 1.0, _SWING), repeat=axes)))
    between = path[:-1, None] + share * (path[1:] - path[:-1])[:, None]  # (W - 1, S, R)
    heights = top_height(chain, between.reshape(len(share) * (len(path) - 1), axes), solid, probe)
    highest: Array = heights.reshape(len(path) - 1, -1).max(axis=1)
    return highest


@dataclass(frozen=True, eq=False)
class ToolClearance:
    """How near stylus, body and spindle come to anything solid at single readings.

    Attributes:
        chain: The machine.
        standard: What is touched.
        setup: Where it is believed to stand.
        probe: In the spindle.
        table_radius: Of the table's face, mm.
    """

    chain: Chain
    standard: Standard
    setup: Setup
    probe: Probe
    table_radius: float

    def gap(self, q: Array) -> tuple[Array, Labels]:
        """Gap between the probe above its ball and anything solid at readings (N, A).

        Returns:
            Smallest gap (N,), mm, and the name of what is nearest (N,).
        """
        near = clearance_on_table(
            self.standard,
            self.setup.T_table_artefact,
            table_to_tool(self.chain, q),
            tip(self.chain, q, self.probe.length),
            self.probe.shape,
            Plate((self.table_radius,) * 2, self.table_radius, -TABLE_THICKNESS, 0.0),
        )
        return near.distance, near.body
