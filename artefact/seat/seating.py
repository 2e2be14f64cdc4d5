"""Whether a standard stands on its table, and how deep one body reaches into another.

Outlines are looked at in the frame of the table's face, bodies as hulls of their corners.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import takewhile
from typing import Any

import numpy as np

from matstd.artefact.body import Base, outline_distance
from matstd.artefact.reach import Solid, table_face
from matstd.twin.frames import Array, apply, fixed_xyz_angles, inverse
from matstd.twin.record import Setup
from matstd.twin.units import DEG

CONTACT_DEPTH = 0.1  # depth up to which bodies count as touching, mm: a clamp lies on what it holds

ONE_SETUP = 1.0
"""Distance up to which two set-ups are one, mm, if they are turned by less than a degree."""

_CORNER_POINTS = 17  # corners of the hull on each rounded corner: 0.03 mm inside one of 25 mm


@dataclass(frozen=True, eq=False)
class Overlap:
    """How deep a body reaches into another."""

    depth: float  # shortest way by which it leaves the other, mm; 0 where they are apart
    aside: Array  # shortest such way parallel to the face, (2,), mm


def base_corners(base: Base, T_table_artefact: Array) -> Array:
    """Corners of the base in the frame of the table's face, (V, 3), the lower half first."""
    (a, b), r = base.half_size, base.corner_radius
    angle = np.linspace(0.0, 0.5 * np.pi, _CORNER_POINTS)
    x, y = a - r + r * np.cos(angle), b - r + r * np.sin(angle)
    xy = np.concatenate([np.column_stack([s * x, t * y]) for s in (1, -1) for t in (1, -1)])
    corners = [np.column_stack([xy, np.full(len(xy), z)]) for z in (0.0, base.thickness)]
    T_face_artefact = inverse(table_face(T_table_artefact)) @ T_table_artefact
    return apply(T_face_artefact, np.concatenate(corners))


def seat_height(T_table_artefact: Array, half_size: tuple[float, float]) -> float:
    """Height of the lowest corner of a base above the origin of the table's face, mm."""
    a, b = half_size
    corners = np.array([[x, y, 0.0] for x in (-a, a) for y in (-b, b)])
    on_face = apply(inverse(table_face(T_table_artefact)), apply(T_table_artefact, corners))
    return float(on_face[:, 2].min())


def over_edge(table: Solid, base: Base, T_table_artefact: Array) -> float:
    """How far the seat of a base reaches beyond the edge of the table, mm; negative inside."""
    corners = base_corners(base, T_table_artefact)
    seat = apply(inverse(table.T_face_solid), corners[: len(corners) // 2])
    round_ = table.half_size[0] if table.is_disc else 0.0
    return float(outline_distance(seat[:, :2], table.half_size, round_).max())


def over_table(table: Solid, x: float, y: float) -> float:
    """How far a place stands beside the table's face, mm; negative on it."""
    at = apply(inverse(table.T_face_solid), np.array([[x, y, 0.0]]))[:, :2]
    round_ = table.half_size[0] if table.is_disc else 0.0
    return float(outline_distance(at, table.half_size, round_)[0])


def same_place(setups: Sequence[Setup], setup: Setup) -> str:
    """Name of an earlier set-up in which the standard stands as in this one; "" for none."""
    for other in takewhile(lambda one: one.name != setup.name, setups):
        moved = inverse(other.T_table_artefact) @ setup.T_table_artefact
        turned = np.abs(fixed_xyz_angles(moved[:3, :3])).max()
        if np.linalg.norm(moved[:3, 3]) < ONE_SETUP and turned < DEG:
            return other.name
    return ""


def off_table(table: Solid, base: Base, T_table_artefact: Array) -> float:
    """Smallest distance of the seat's outline from the table beside it, mm; 0 where it is on it."""
    corners = base_corners(base, T_table_artefact)
    return _apart(corners[: len(corners) // 2, :2], table.corners(256)[:, :2])


def middle_room(table: Solid, T_table_artefact: Array) -> float:
    """Radius of the largest disc about the standard's own axis that lies on the table, mm."""
    T_face_artefact = inverse(table_face(T_table_artefact)) @ T_table_artefact
    middle = apply(inverse(table.T_face_solid), T_face_artefact[:3, 3][None])
    round_ = table.half_size[0] if table.is_disc else 0.0
    return max(0.0, -float(outline_distance(middle[:, :2], table.half_size, round_)[0]))


def overlap(body: Array, other: Array) -> Overlap:
    """How deep the hull of a body's corners (V, 3) reaches into that of another.

    Two convex bodies meet where the origin lies in the hull of all differences of their corners;
    the way out is the distance to its faces.
    """
    none = Overlap(0.0, np.zeros(2))
    if np.any(body.min(axis=0) >= other.max(axis=0)) or np.any(
        other.min(axis=0) >= body.max(axis=0)
    ):
        return none
    planes = _differences(other, body)
    if planes[:, 3].max() >= 0.0:
        return none
    flat = np.hypot(planes[:, 0], planes[:, 1])
    way = -planes[:, 3] / np.maximum(flat, 1e-9)
    best = int(np.argmin(way))
    return Overlap(float(-planes[:, 3].max()), way[best] * planes[best, :2] / flat[best])


def _differences(first: Array, second: Array) -> Array:
    """Planes (F, 4) round all differences of two sets of points, normals outwards."""
    from scipy.spatial import ConvexHull

    hull = ConvexHull((first[:, None] - second[None]).reshape(-1, 3))
    return np.asarray(hull.equations)


def _apart(first: Array, second: Array) -> float:
    """Distance of the hulls of two sets of points in the plane, mm."""
    from scipy.spatial import ConvexHull

    points = (first[:, None] - second[None]).reshape(-1, 2)
    hull = ConvexHull(points)
    if hull.equations[:, 2].max() <= 0.0:
        return 0.0
    a = points[hull.vertices]
    b = np.roll(a, -1, axis=0)
    along = b - a
    share = np.clip(-(a * along).sum(axis=1) / (along**2).sum(axis=1), 0.0, 1.0)
    return float(np.hypot(*(a + share[:, None] * along).T).min())


def manifold(corners: Array, triangles: np.ndarray) -> Any:
    """A mesh as a solid of manifold3d."""
    import manifold3d

    mesh = manifold3d.Mesh(
        vert_properties=np.ascontiguousarray(corners, dtype=np.float32),
        tri_verts=np.ascontiguousarray(triangles, dtype=np.uint32),
    )
    return manifold3d.Manifold(mesh)


def common_part(
    corners: Array, triangles: np.ndarray, other: Array, other_triangles: np.ndarray | None = None
) -> Array:
    """Corners (V, 3) of what a closed mesh has in common with another, none where that is nothing.

    Args:
        corners: Of the mesh, shape (V, 3), mm.
        triangles: Of the mesh, shape (F, 3).
        other_triangles: Of the other; None for the hull of its corners.
    """
    import manifold3d

    second = (
        manifold3d.Manifold.hull_points(np.ascontiguousarray(other, dtype=np.float32))
        if other_triangles is None
        else manifold(other, other_triangles)
    )
    both = manifold(corners, triangles) ^ second
    return np.asarray(both.to_mesh().vert_properties, dtype=float)[:, :3].reshape(-1, 3)
