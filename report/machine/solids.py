"""Boxes, cylinders and balls as triangles: what plain bodies are made of."""

from dataclasses import dataclass
from typing import Any

import numpy as np

from matstd.twin.frames import Array, unit

FOUNDATION = "f"  # what carries the bodies that do not move; other names are those of links
_CYLINDER_SIDES = 40  # sides of a cylinder


@dataclass(frozen=True, eq=False)
class Drawn:
    """Triangles of one colour on one link."""

    on: str  # link whose body they are: an axis, `w`, `t`, or `FOUNDATION`
    colour: str  # as `#rrggbb`
    corners: Array  # in the frame of the machine with every axis at zero, (T, 3, 3), mm


def box(half: tuple[float, float], low: float, high: float) -> Array:
    """Upright box round the z axis, (12, 3, 3)."""
    return block(np.array([-half[0], -half[1], low]), np.array([half[0], half[1], high]))


def block(low: Array, high: Array, axes: Array | None = None) -> Array:
    """Box between corners `low` and `high`, mm, along the rows of `axes`, (12, 3, 3)."""
    unit_box = _triangles(_trimesh().box((1.0, 1.0, 1.0)))
    corners = 0.5 * (low + high) + unit_box * (high - low)
    return corners if axes is None else corners @ axes


def cylinder(low_radius: float, high_radius: float, low: float, high: float) -> Array:
    """Upright, or a cone; with its ends."""
    angle = np.linspace(0.0, 2.0 * np.pi, _CYLINDER_SIDES + 1)
    ring = np.column_stack([np.cos(angle), np.sin(angle)])
    below, above = (
        np.column_stack([r * ring, np.full(len(ring), z)])
        for r, z in ((low_radius, low), (high_radius, high))
    )
    foot, head = np.array([0.0, 0.0, low]), np.array([0.0, 0.0, high])
    a, b, c, d = below[:-1], below[1:], above[:-1], above[1:]
    ends = [np.broadcast_to(p, a.shape) for p in (foot, head)]
    sides = [(a, b, d), (a, d, c), (ends[0], b, a), (ends[1], c, d)]
    return np.concatenate([np.stack(side, axis=1) for side in sides])


def rod(start: Array, end: Array, radius: float) -> Array:
    """Cylinder between two points, (3,) each, mm."""
    along = end - start
    length = float(np.linalg.norm(along))
    return start + cylinder(radius, radius, 0.0, length) @ frame_along(along / length)


def frame_along(z: Array) -> Array:
    """Right-handed directions in rows, the third of which is a unit vector, (3, 3)."""
    x = unit(np.cross(np.eye(3)[int(np.argmin(np.abs(z)))], z))
    return np.array([x, np.cross(z, x), z])


def ball(radius: float) -> Array:
    """Round the origin."""
    return _triangles(_trimesh().icosphere(2, radius))


def _trimesh() -> Any:
    import trimesh

    return trimesh.creation


def _triangles(mesh: Any) -> Array:
    return np.asarray(mesh.triangles, dtype=np.float64)
