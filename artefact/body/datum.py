"""Datum features of a standard: spheres on stems, the plane of the base, mounting holes."""

from dataclasses import dataclass
from typing import NamedTuple

import numpy as np

from matstd.artefact.body.patch import Hit, read_only, rows, sphere_entry
from matstd.twin.errors import ShapeMismatch
from matstd.twin.frames import Array, Mask, outward, unit

STEM_CLEARANCE = 15.0 * np.pi / 180.0
"""Angle kept between a touch on a sphere and the rim of its stem, rad."""


@dataclass(frozen=True, eq=False)
class DatumSphere:
    """A precision ball on an upright conical stem.

    Its parameters are azimuth and elevation, rad: ``p = c + r (cos e cos a, cos e sin a, sin e)``.
    """

    name: str  # feature name, SPH1 ...
    centre: Array  # shape (3,), artefact frame, mm
    radius: float  # of the ball, mm
    stem_radius: float  # of the stem's cone at the height of the ball's centre, mm
    foot_radius: float  # of the stem at its foot, mm
    foot: float  # height of the foot (the base's top face) in the artefact frame, mm
    # whether its touches are held out from the identification, to prove the model
    proves: bool = False

    def __post_init__(self) -> None:
        object.__setattr__(self, "centre", read_only(self.centre, (3,), f"{self.name}: centre"))
        if not 0.0 < self.stem_radius < self.radius:
            raise ShapeMismatch(
                f"{self.name}: stem radius {self.stem_radius:g} mm, expected between 0 and the "
                f"ball's radius {self.radius:g} mm"
            )
        if not self.foot < self.centre[2] - self.radius:
            raise ShapeMismatch(
                f"{self.name}: foot at {self.foot:g} mm, expected below the ball, whose lowest "
                f"point is at {self.centre[2] - self.radius:g} mm"
            )

    @property
    def rim(self) -> float:
        """Elevation of the circle in which stem and ball meet, rad (negative).

        The cone's radius a depth s below the centre, ``stem + k s``, equals the ball's.
        """
        k = (self.foot_radius - self.stem_radius) / (self.centre[2] - self.foot)
        root = np.sqrt(self.radius**2 * (1.0 + k**2) - self.stem_radius**2)
        below = (root - k * self.stem_radius) / (1.0 + k**2)
        return float(-np.arcsin(below / self.radius))

    def point(self, uv: Array) -> Array:
        """Points of the sphere, (N, 3), mm."""
        return self.centre + self.radius * self.normal(uv)

    def normal(self, uv: Array) -> Array:
        """Outward unit normals at (azimuth, elevation), (N, 3)."""
        return outward(*rows(uv).T)

    def curvature(self, uv: Array) -> Array:
        """Principal curvatures, (N, 2), 1/mm: convex everywhere, so ``-1/r``."""
        return np.full((len(rows(uv)), 2), -1.0 / self.radius)

    def project(self, points: Array) -> Array:
        """Parameters of the foot points; nan for the centre itself."""
        out = rows(points) - self.centre
        length = np.linalg.norm(out, axis=1)
        azimuth = np.arctan2(out[:, 1], out[:, 0])
        elevation = np.arctan2(out[:, 2], np.hypot(out[:, 0], out[:, 1]))
        return np.where((length > 0.0)[:, None], np.column_stack([azimuth, elevation]), np.nan)

    def is_bare(self, uv: Array) -> Mask:
        """Whether the surface is that of the ball and not of its stem."""
        return rows(uv)[:, 1] >= self.rim

    def contains(self, uv: Array) -> Mask:
        """Whether the point stays `STEM_CLEARANCE` away from the rim of the stem."""
        return rows(uv)[:, 1] >= self.rim + STEM_CLEARANCE

    def contact(self, start: Array, direction: Array, radius: float) -> Hit:
        """First contact of a moving ball, closed form: ``|start + t d - c| = r + radius``."""
        p = rows(start)
        d = unit(rows(direction, len(p)))
        travel = sphere_entry(self.centre, p, d, self.radius + radius)
        travel = np.where(np.isfinite(travel), travel, np.nan)
        return Hit(self.project(p + travel[:, None] * d), travel)


@dataclass(frozen=True, slots=True)
class DatumPlane:
    """The finished top face of the base, normal +z; its parameters are x and y."""

    name: str
    height: float  # of the face, artefact frame, mm
    half_size: tuple[float, float]  # half sides of its outline, mm
    corner_radius: float  # of its outline, mm

    def point(self, uv: Array) -> Array:
        """Points (N, 3), mm."""
        uv = rows(uv)
        return np.column_stack([uv, np.full(len(uv), self.height)])

    def normal(self, uv: Array) -> Array:
        """Outward unit normals, (N, 3): +z everywhere."""
        return np.tile([0.0, 0.0, 1.0], (len(rows(uv)), 1))

    def curvature(self, uv: Array) -> Array:
        """Principal curvatures, (N, 2): zero."""
        return np.zeros((len(rows(uv)), 2))

    def project(self, points: Array) -> Array:
        """Parameters (x, y) of the foot points, (N, 2)."""
        return rows(points)[:, :2].copy()

    def contains(self, uv: Array) -> Mask:
        """Whether (x, y) lies within the outline; bodies on the face are ignored."""
        return outline_distance(rows(uv), self.half_size, self.corner_radius) <= 0.0

    def contact(self, start: Array, direction: Array, radius: float) -> Hit:
        """First contact of a moving ball: its centre descends to ``height + radius``."""
        p = rows(start)
        d = unit(rows(direction, len(p)))
        fall = np.where(d[:, 2] < 0.0, d[:, 2], np.nan)
        travel = (self.height + radius - p[:, 2]) / fall
        uv = (p + travel[:, None] * d)[:, :2]
        missed = ~self.contains(uv)
        return Hit(np.where(missed[:, None], np.nan, uv), np.where(missed, np.nan, travel))


@dataclass(frozen=True, slots=True)
class MountingHole:
    """A counterbored through hole of the base, for a cylinder-head screw."""

    name: str  # HOLE1 ...
    x: float  # of its axis, artefact frame, mm
    y: float  # of its axis, artefact frame, mm
    radius: float  # of the through hole, mm
    bore_radius: float  # of the counterbore, mm
    bore_depth: float  # of the counterbore below the base's top face, mm

    def __post_init__(self) -> None:
        if not 0.0 < self.radius < self.bore_radius:
            raise ShapeMismatch(
                f"{self.name}: hole radius {self.radius:g} mm, expected between 0 and the "
                f"counterbore's {self.bore_radius:g} mm"
            )


def outline_distance(xy: Array, half_size: tuple[float, float], corner_radius: float) -> Array:
    """Signed distance to a rectangle with rounded corners, negative inside, mm.

    Args:
        xy: Shape (N, 2), mm.
        half_size: Half sides, mm.
        corner_radius: At most the smaller half side (equal: a disc), mm.

    Returns:
        Shape (N,), mm; exact inside and outside.
    """
    beyond = np.abs(xy) - (np.asarray(half_size) - corner_radius)
    outside = np.linalg.norm(np.maximum(beyond, 0.0), axis=1)
    return outside + np.minimum(beyond.max(axis=1), 0.0) - corner_radius


_FIT_TOLERANCE = 1e-14  # relative change of the unknowns at which the fit ends


class FittedSphere(NamedTuple):
    """A sphere, and the residuals of its points."""

    centre: Array  # (3,), mm
    radius: float  # mm
    left: Array  # distance of every point from the sphere, outwards, (N,), mm
    cofactor: Array  # covariance of centre and radius for points of unit variance, (4, 4)


def fitted_sphere(points: Array, start: Array | None = None) -> FittedSphere:
    """Least-squares sphere.

    Args:
        points: (N, 3), four or more, mm.
        start: Approximate centre, (3,), mm; None for that of the linear form
            ``2 c.p + (r^2 - c.c) = p.p``, which needs points all round the sphere.
    """
    from scipy.optimize import least_squares

    if start is None:
        A = np.column_stack([2.0 * points, np.ones(len(points))])
        start = np.linalg.lstsq(A, (points**2).sum(axis=1), rcond=None)[0][:3]

    def left(x: Array) -> Array:
        return np.asarray(np.linalg.norm(points - x[:3], axis=1) - x[3])

    def jacobian(x: Array) -> Array:
        away = points - x[:3]
        length = np.linalg.norm(away, axis=1, keepdims=True)
        return -np.column_stack([away / length, np.ones(len(points))])

    first = np.append(start, np.linalg.norm(points - start, axis=1).mean())
    solved = least_squares(
        left, first, jacobian, method="lm", xtol=_FIT_TOLERANCE, ftol=_FIT_TOLERANCE
    ).x
    J = jacobian(solved)
    cofactor = np.asarray(np.linalg.pinv(J.T @ J), dtype=np.float64)
    return FittedSphere(solved[:3], float(solved[3]), left(solved), cofactor)
