"""Protocol of the touchable surfaces of a standard, and contact with a point."""

from enum import StrEnum
from typing import NamedTuple, Protocol

import numpy as np
from numpy.typing import ArrayLike

from matstd.twin.errors import ShapeMismatch
from matstd.twin.frames import Array, Mask


class Hit(NamedTuple):
    """Where a moving ball first meets one surface."""

    uv: Array  # (N, 2)  surface parameters of the contact point; nan where it never meets
    travel: Array  # (N,)  of the ball centre along the direction, mm; nan where it never meets


class Meeting(StrEnum):
    """What a moving ball meets; the values are parts of sentences in a report."""

    SURFACE = "meets the surface"
    EDGE = "meets the trimmed edge of the patch"
    SIDE = "meets the side of a column, a stem, a hole, the core or the base"
    INSIDE = "starts in the material"
    NOTHING = "meets nothing within the travel"
    UNRESOLVED = "the contact search did not converge"


class Surface(Protocol):
    """A touchable surface in the artefact frame; everything is vectorised over N rows."""

    @property
    def name(self) -> str:
        """Name of the feature: FF1, SPH1, DATUM_A."""

    def point(self, uv: Array) -> Array:
        """Points (N, 3) at parameters (N, 2), mm."""

    def normal(self, uv: Array) -> Array:
        """Outward unit normals (N, 3)."""

    def curvature(self, uv: Array) -> Array:
        """Principal curvatures (N, 2), 1/mm, largest first; positive = concave from outside."""

    def project(self, points: Array) -> Array:
        """Parameters (N, 2) of the foot points of points (N, 3); nan where none was found."""

    def contains(self, uv: Array) -> Mask:
        """Whether the parameters lie on the touchable part (N,)."""

    def contact(self, start: Array, direction: Array, radius: float) -> Hit:
        """First contact of balls (N, 3) moving along unit directions (N, 3)."""


def read_only(
    values: ArrayLike, shape: tuple[int, ...] | None = None, what: str = "array"
) -> Array:
    """A read-only float64 copy; raises ShapeMismatch for another shape or a value not finite."""
    copy = np.array(values, dtype=np.float64)
    if shape is not None and copy.shape != shape:
        raise ShapeMismatch(f"{what}: shape {copy.shape}, expected {shape}")
    if not np.isfinite(copy).all():
        raise ShapeMismatch(f"{what}: every number must be finite")
    copy.setflags(write=False)
    return copy


def rows(values: ArrayLike, count: int | None = None) -> Array:
    """Vectors as rows (N, 3); a single vector is repeated `count` times."""
    table = np.atleast_2d(np.asarray(values, dtype=np.float64))
    return table if count is None else np.broadcast_to(table, (count, table.shape[1]))


def sphere_entry(points: Array, start: Array, direction: Array, radius: float) -> Array:
    """Travel at which a moving ball first touches a point, ``|start + t d - p| = radius``.

    A ball that is already past the point never touches it.

    Args:
        points: Shape (..., 3), mm.
        start: Ball centres, broadcast against the points, mm.
        direction: Unit vectors, broadcast against the points.
        radius: Of the ball, mm.

    Returns:
        Shape (...), mm; inf where the ball never touches; negative where it starts on the point.
    """
    to_point = points - start
    along = np.einsum("...i,...i->...", to_point, direction)
    across2 = np.einsum("...i,...i->...", to_point, to_point) - along**2
    half_chord = np.sqrt(np.maximum(radius**2 - across2, 0.0))
    touches = (across2 <= radius**2) & (along + half_chord >= 0.0)
    return np.where(touches, along - half_chord, np.inf)
