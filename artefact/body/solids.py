"""The solid bodies of a standard as signed distances: exact for convex ones, else lower bounds.

A lower bound is on the safe side: a clearance is never overestimated.
"""

from dataclasses import dataclass
from typing import Protocol

import numpy as np

from matstd.artefact.body.datum import outline_distance
from matstd.artefact.body.freeform import FreeformPatch
from matstd.twin.frames import Array, apply

BLEND = 3.0  # fillet radius at the foot of a pillar or post, mm
_MAX_STEPS = 60  # bound: where a ball grazes a body, each Newton step only halves the gap
_SECANT = 1e-5  # mm
_CONTACT_GAP = 1e-9  # mm: distance at which a ball counts as touching


class Body(Protocol):
    """A solid in the artefact frame."""

    @property
    def hull(self) -> tuple[Array, float]:
        """Centre (3,) and radius of a ball that holds the body, mm."""

    def distance(self, points: Array) -> Array:
        """Signed distance of points (N, 3), (N,), mm, negative inside; never too large."""


@dataclass(frozen=True, slots=True)
class Plate:
    """An upright prism over a rectangle with rounded corners: the base."""

    half_size: tuple[float, float]  # half sides of the outline, mm
    corner_radius: float  # of the outline, mm; equal to both half sides it is a disc
    low: float  # height of the lower face, mm
    high: float  # height of the upper face, mm

    @property
    def hull(self) -> tuple[Array, float]:
        """Centre and radius of the ball through the corners of the box round it."""
        middle = np.array([0.0, 0.0, 0.5 * (self.low + self.high)])
        return middle, float(np.linalg.norm([*self.half_size, 0.5 * (self.high - self.low)]))

    def distance(self, points: Array) -> Array:
        """Exact signed distance, (N,), mm."""
        sideways = outline_distance(points[:, :2], self.half_size, self.corner_radius)
        upright = np.abs(points[:, 2] - 0.5 * (self.low + self.high)) - 0.5 * (self.high - self.low)
        return _corner(sideways, upright)


@dataclass(frozen=True, slots=True)
class Cone:
    """An upright cone frustum: the core, or the stem of a sphere."""

    x: float  # of its axis, mm
    y: float  # of its axis, mm
    low: float  # height of the lower face, mm
    high: float  # height of the upper face, mm
    low_radius: float  # radius below, mm
    high_radius: float  # radius above, mm
    blend: bool = False  # whether its foot is rounded into the plane at its lower face

    @property
    def hull(self) -> tuple[Array, float]:
        """Centre half way up, and the way from there to the farther rim."""
        middle = np.array([self.x, self.y, 0.5 * (self.low + self.high)])
        widest = max(self.low_radius + BLEND * self.blend, self.high_radius)
        return middle, float(np.hypot(0.5 * (self.high - self.low), widest))

    def distance(self, points: Array) -> Array:
        """Exact signed distance, (N,), mm, in the half plane of radius and height."""
        r = np.hypot(points[:, 0] - self.x, points[:, 1] - self.y)
        z = points[:, 2] - 0.5 * (self.low + self.high)
        half = 0.5 * (self.high - self.low)
        rim = np.where(z < 0.0, self.low_radius, self.high_radius)
        to_cap = np.hypot(np.maximum(r - rim, 0.0), np.abs(z) - half)
        edge = np.array([self.high_radius - self.low_radius, 2.0 * half])
        from_low = np.column_stack([r - self.low_radius, z + half])
        along = np.clip(from_low @ edge / (edge @ edge), 0.0, 1.0)
        to_side = _length(*(from_low - along[:, None] * edge).T)
        beside = from_low @ np.array([edge[1], -edge[0]])
        inside = (beside < 0.0) & (np.abs(z) < half)
        distance = np.where(inside, -1.0, 1.0) * np.minimum(to_cap, to_side)
        return _with_blend(distance, points[:, 2] - self.low) if self.blend else distance


@dataclass(frozen=True, slots=True, eq=False)
class Ball:
    """A datum sphere as a solid."""

    centre: Array  # shape (3,), mm
    radius: float  # in mm

    @property
    def hull(self) -> tuple[Array, float]:
        """The ball itself."""
        return self.centre, self.radius

    def distance(self, points: Array) -> Array:
        """Exact signed distance, (N,), mm."""
        return _length(*(points - self.centre).T) - self.radius


@dataclass(frozen=True, slots=True, eq=False)
class Column:
    """The prism that carries a patch, with the freeform face as its lid.

    The distance is the larger of two lower bounds: that of the box around the column, and
    ``(z - h) cos(steepest slope)`` over the height field continued sideways as a constant.
    """

    patch: FreeformPatch  # the lid and its frame
    top: float  # largest height of the lid above the patch plane, mm
    steepest: float  # cosine of the largest slope of the lid
    # height of a plane into which its foot is rounded, mm; None for a sharp edge
    foot: float | None = None

    @property
    def hull(self) -> tuple[Array, float]:
        """Centre and radius of the ball through the corners of the box round it."""
        low, high = -self.patch.depth, self.top
        middle = apply(self.patch.T_artefact_patch, np.array([0.0, 0.0, 0.5 * (low + high)]))
        to_corner = float(np.linalg.norm([*self.patch.half_size, 0.5 * (high - low)]))
        return middle, to_corner + (0.0 if self.foot is None else 2.0 * BLEND)

    def distance(self, points: Array) -> Array:
        """Lower bound of the signed distance, (N,), mm; its sign is exact."""
        patch = self.patch
        local = apply(patch.T_patch_artefact, points)
        half = np.asarray(patch.half_size)
        middle, half_height = 0.5 * (self.top - patch.depth), 0.5 * (self.top + patch.depth)
        # coordinate by coordinate: sums and maxima along rows of three take five times as long
        x, y = np.abs(local[:, 0]) - half[0], np.abs(local[:, 1]) - half[1]
        z = np.abs(local[:, 2] - middle) - half_height
        out = _length(*(np.maximum(away, 0.0) for away in (x, y, z)))
        box = out + np.minimum(np.maximum(np.maximum(x, y), z), 0.0)
        # the lid is nowhere below its lowest pole: a box distance above that bound decides alone
        most = (local[:, 2] - patch.heights.min()) * self.steepest
        near = np.flatnonzero((box < 2.0 * (self.top + np.abs(half).max())) & (box < most))
        uv = np.clip(local[near, :2], -half, half)
        over = (local[near, 2] - patch.height(uv)) * self.steepest
        box[near] = np.maximum(box[near], over)
        return box if self.foot is None else _with_blend(box, points[:, 2] - self.foot)

    def distance_from_lid(self, points: Array) -> Array:
        """Distance from the lid, continued beyond its edges, by foot points, (N,), mm.

        No more than the smallest concave radius of the lid, up to which a foot point is the
        nearest one, and zero for points below or beside it.
        """
        patch = self.patch
        uv = patch.project(points)
        away = points - patch.point(np.nan_to_num(uv))
        above = np.isfinite(uv).all(axis=1) & (away @ patch.direction > 0.0)
        return np.where(above, np.minimum(_length(*away.T), patch.sharpest_valley), 0.0)


def _length(*coordinates: Array) -> Array:
    """Lengths of vectors by their coordinates, (N,) each."""
    return np.asarray(np.sqrt(sum(c * c for c in coordinates)))


def column(patch: FreeformPatch, foot: float | None = None) -> Column:
    """The column of a patch with its highest point and steepest slope found on a 1 mm grid."""
    top, slope = patch.extremes
    # between the nodes of the grid the lid can be higher by slope times half a pitch at most, and
    # hardly steeper: a tenth of a millimetre and two degrees cover every design that check() passes
    return Column(
        patch=patch, top=top + 0.1, steepest=float(np.cos(min(slope + 0.035, 1.5))), foot=foot
    )


def entry(body: Body, start: Array, direction: Array, radius: float) -> Array:
    """Travel at which a moving ball first touches a convex body.

    ``f(t) = distance(start + t d) - radius`` is convex in t, so Newton's method from outside
    approaches the first root and never passes it.

    Args:
        body: Convex, with an exact distance.
        start: Ball centres, shape (N, 3), mm.
        direction: Unit vectors, shape (N, 3).
        radius: Of the ball, mm.

    Returns:
        Shape (N,), mm; inf where the ball never touches; zero where it starts on or in the body.
    """
    travel = np.zeros(len(start))
    active = np.arange(len(start))
    for _ in range(_MAX_STEPS):
        p, d = start[active] + travel[active, None] * direction[active], direction[active]
        gap = body.distance(p) - radius
        # backward secant: on a convex function it is at least as steep as the tangent, so that the
        # step never passes the root
        rate = (gap + radius - body.distance(p - _SECANT * d)) / _SECANT
        lost = rate > -1e-6
        done = gap < _CONTACT_GAP
        travel[active[lost & ~done]] = np.inf
        go = ~(lost | done)
        travel[active[go]] += gap[go] / np.minimum(-rate[go], 1.0)
        active = active[go]
        if not len(active):
            break
    return travel


def _corner(a: Array, b: Array) -> Array:
    """Signed distance to the intersection of two half spaces at right angles."""
    out = np.hypot(np.maximum(a, 0.0), np.maximum(b, 0.0))
    return out + np.minimum(np.maximum(a, b), 0.0)


def _with_blend(distance: Array, above: Array) -> Array:
    """Distance from a wall with a fillet, of points at a height above the plane at its foot.

    Exact at an upright wall, ``R - |(R - d, R - z)|``; too small where the wall leans back.
    """
    near = (distance < BLEND) & (above > 0.0) & (above < BLEND)
    round_it = BLEND - np.hypot(BLEND - distance[near], BLEND - above[near])
    distance[near] = np.minimum(distance[near], round_it)
    return distance
