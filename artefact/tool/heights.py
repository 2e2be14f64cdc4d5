"""Heights of Z at which the tool clears everything that stands on the table."""

from dataclasses import dataclass, field, replace
from itertools import pairwise, product
from typing import NamedTuple

import numpy as np

from matstd.artefact.body import Standard
from matstd.artefact.reach import ProbeShape, Workshop, still_frames, table_face
from matstd.twin.errors import DesignError
from matstd.twin.frames import Array, apply, inverse
from matstd.twin.machine import Chain, tool_and_directions
from matstd.twin.record import Labels, Setup
from matstd.twin.units import DEG

NOSE_HEIGHT = 150.0  # how much of the spindle above the gauge line is kept clear, mm
_BODY_RADIUS = 25.0  # mm; of optical probes 20 to 32


@dataclass(frozen=True)
class Probe:
    """Probe with a ball stylus along the tool axis, mm."""

    radius: float = 3.0
    length: float = 160.0  # from the spindle gauge point to the ball centre
    # (end, radius) of its cylinders from the ball centre up to the gauge point: stylus, stem, body,
    # holder. Where not given, a stylus of two thirds of the ball and half the length, and a body of
    # 50 mm
    stack: tuple[tuple[float, float], ...] = ()
    nose_radius: float = 45.0  # of the spindle nose above the gauge line
    # whether the project states it; None of programs, which do not say
    nose_is_stated: bool | None = field(default=None, compare=False)

    def __post_init__(self) -> None:
        if not 0.0 < self.radius < self.length:
            raise DesignError(
                f"probe of radius {self.radius} mm and length {self.length} mm: "
                "expected 0 < radius < length"
            )
        if not self.stack:
            stylus = (0.5 * self.length, self.radius * 2.0 / 3.0)
            object.__setattr__(self, "stack", (stylus, (self.length, _BODY_RADIUS)))
        if abs(self.stack[-1][0] - self.length) > 1e-6 or min(r for _, r in self.stack) <= 0.0:
            raise DesignError(
                f"cylinders of a probe {self.stack}: expected positive radii, and the last to end "
                f"at the gauge point, {self.length:g} mm from the ball centre"
            )

    def at_length(self, length: float) -> "Probe":
        """The same probe, held longer or shorter."""
        below = [(end, radius) for end, radius in self.stack[:-1] if end < length]
        return replace(self, length=length, stack=(*below, (length, self.stack[-1][1])))

    @property
    def tool_length(self) -> float:
        """Length in the tool table, mm: to the ball's far pole, not to its centre."""
        return self.length + self.radius

    @property
    def shape(self) -> ProbeShape:
        """The stack and the spindle nose as cylinders upwards from the ball centre."""
        nose = (self.length + NOSE_HEIGHT, self.nose_radius)
        return ProbeShape(self.radius, (*self.stack, nose))

    def outline(self, sides: int = 16) -> Array:
        """Points round the front rims of all but the stylus and the rear one, tool frame.

        From the ball centre. Together with the ball they bound the tool from below in any direction
        that a tilting head may give it, also upwards: the rims are polygons from outside.

        Returns:
            Shape (M, 3), mm.
        """
        angle = np.arange(sides) * (2.0 * np.pi / sides)
        ring = np.stack([np.cos(angle), np.sin(angle), np.zeros(sides)], axis=-1)
        lows = [*(end for end, _ in self.stack), self.length + NOSE_HEIGHT]
        radii = [*(r for _, r in self.stack[1:]), self.nose_radius, self.nose_radius]
        return np.concatenate(
            [
                radius / np.cos(np.pi / sides) * ring + [0.0, 0.0, low]
                for low, radius in zip(lows, radii, strict=True)
            ]
        )


OVERSHOOT = 5.0 * DEG  # how far before a rotary position the last motion towards it begins, rad

_TURN_SAMPLES = 25
"""Samples of every axis that turns in a move: all turn, in no order that is known. Half a turn is
cut every 7 degrees, between which nothing within 300 mm of an axis rises by 0.6 mm."""

_SWINGS = (
    9,
    _TURN_SAMPLES,
    97,
)  # samples one after another, until they decide; each has a ninth the rise


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
    q[:, chain.rotary_columns] = rotary
    return q


def top_height(chain: Chain, rotary: Array, solid: SolidHull, probe: Probe) -> Array:
    """Reading of Z at which the lowest point of the tool is level with the highest obstacle.

    Args:
        rotary: Readings of the rotary axes, shape (V, R), rad.
        solid: What stands on the table, table frame.

    Returns:
        Shape (V,), mm.
    """
    q = readings_at(chain, rotary)
    T_table_tool, along = tool_and_directions(chain, q)
    up = along[:, :, chain.linear_axes.index("Z")]
    highest = np.full(len(q), -np.inf)
    for on, T_still_table in still_frames(solid.on.tolist(), chain, q).items():
        mine, T_table_still = solid.on == on, inverse(T_still_table)
        level = np.einsum("vji,vj->vi", T_table_still[:, :3, :3], up)
        shift = np.einsum("vi,vi->v", up, T_table_still[:, :3, 3])
        most = (level @ solid.points[mine].T + solid.radii[mine]).max(axis=1)
        highest = np.maximum(highest, most + shift)
    up_in_tool = np.einsum("vji,vj->vi", T_table_tool[:, :3, :3], up)
    below = (up_in_tool @ probe.outline().T).min(axis=1)
    below = np.minimum(below, -probe.radius)
    gauge_to_ball = np.array([0.0, 0.0, -probe.length])
    return highest - below - np.einsum("vi,vi->v", up, apply(T_table_tool, gauge_to_ball))


def swing_height(
    chain: Chain, path: Array, solid: SolidHull, probe: Probe, allowed: float = -np.inf
) -> Array:
    """Highest `top_height` along a path of the rotary axes, whichever turns first; from above.

    Between two samples that are d apart a point at a distance r from an axis rises above both by
    r d^2 / 8 at most, which is added. Where that makes the difference, it is looked at closer.

    Args:
        path: Rotary readings in order, shape (W, R), rad.
        solid: What stands on the table, table frame.
        allowed: Reading of Z that must not be exceeded, mm: below it a coarse bound will do.

    Returns:
        Of each of the W - 1 moves, mm.
    """
    arms = _arms(chain, solid, probe)
    highest = np.empty(len(path) - 1)
    for i, (start, end) in enumerate(pairwise(path)):
        for samples in _SWINGS:
            met, rise = _swing_maximum(chain, start, end - start, samples, solid, probe, arms)
            highest[i] = met + rise
            if highest[i] <= allowed or (met > allowed and samples >= _TURN_SAMPLES):
                break
    return highest


def _swing_maximum(
    chain: Chain,
    start: Array,
    turn_by: Array,
    samples: int,
    solid: SolidHull,
    probe: Probe,
    arms: Array,
) -> tuple[float, float]:
    """Highest `top_height` at samples of one turn, and how much more it may be between them."""
    shares = [np.linspace(0.0, 1.0, samples if angle else 1) for angle in turn_by]
    between = start + np.array(list(product(*shares))) * turn_by
    rise = float(np.sum(arms * (turn_by / (samples - 1)) ** 2)) / 8.0
    return float(top_height(chain, between, solid, probe).max(initial=-np.inf)), rise


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


def home_readings(chain: Chain) -> Array:
    """Rotary readings (R,) where programs begin and end: zero, or as near as the travel allows."""
    return np.array([np.clip(0.0, *chain.link(name).range) for name in chain.rotary_axes])
