"""Clamps and fixtures drawn elsewhere: a mesh covered by boxes that a program can state."""

from dataclasses import dataclass
from pathlib import Path

import numpy as np

from matstd.artefact.reach.workshop import Solid
from matstd.twin.errors import BadFile
from matstd.twin.frames import Array

MOST_BOXES = 24  # of one mesh: two lines of a program's head each
_SMALLEST_CUT = 4.0  # mm: a box with no side longer is not cut any further
_MIN_FILL = 0.85  # of a box filled by its two halves: no cut would take much off it


@dataclass(frozen=True, eq=False)
class DrawnBody:
    """A body from a mesh file: read once, wherever it stands."""

    boxes: Array  # lowest and highest corners of boxes that hold its surface, (B, 2, 3), mm
    corners: Array  # of its triangles, (V, 3), mm
    triangles: np.ndarray  # corners of each, (F, 3); none where the mesh encloses no volume

    def solids(self, name: str, T_face_mesh: Array, on: str = "") -> tuple[Solid, ...]:
        """Its boxes, numbered, as upright bodies.

        Args:
            T_face_mesh: Where it stands in the frame of the table's face, turned about z alone.
        """
        return tuple(
            _box(low, high, f"{name}.{i}", T_face_mesh, on)
            for i, (low, high) in enumerate(self.boxes, start=1)
        )


def read_drawn_body(path: str | Path, most: int = MOST_BOXES) -> DrawnBody:
    """A mesh, and upright boxes whose union holds its surface: nothing gets in but through them.

    The box that promises most is cut in the middle of its longest side, and each half shrunk to
    what it holds of the surface, until there are enough of them.

    Args:
        path: STL file, mm.
        most: Boxes at most.

    Raises:
        BadFile: No mesh, or an empty one.
    """
    import trimesh

    whole = mesh_triangles(Path(path))
    corners, back = np.unique(whole.reshape(-1, 3), axis=0, return_inverse=True)
    triangles = back.reshape(-1, 3)
    mesh = trimesh.Trimesh(corners, triangles, process=False)
    is_closed = mesh.is_watertight and mesh.is_winding_consistent and mesh.volume > 0.0
    parts = sorted(_cover(whole, most), key=_volume, reverse=True)
    return DrawnBody(
        boxes=np.array([[part.min(axis=(0, 1)), part.max(axis=(0, 1))] for part in parts]),
        corners=corners,
        triangles=triangles if is_closed else triangles[:0],
    )


def _cover(triangles: Array, most: int) -> list[Array]:
    """The triangles in lots, one for each box."""
    boxes = [triangles]
    done: list[Array] = []
    while boxes and len(boxes) + len(done) < most:
        boxes.sort(key=_volume)
        whole = boxes.pop()
        halves = _halves(whole)
        if len(halves) < 2 or sum(map(_volume, halves)) > _MIN_FILL * _volume(whole):
            thirds = [part for half in halves for part in _halves(half)]
            if len(thirds) < 2 or sum(map(_volume, thirds)) > _MIN_FILL * _volume(whole):
                done.append(whole)
                continue
        boxes += halves
    return [*boxes, *done]


def mesh_triangles(path: Path, expected: str = "an STL file") -> Array:
    """Corners of all triangles of a mesh file, (T, 3, 3), mm; raises BadFile."""
    import trimesh

    try:
        mesh = trimesh.load(path, force="mesh", process=False)
        triangles = np.array(mesh.triangles, dtype=float).reshape(-1, 3, 3)
    except OSError as error:
        raise BadFile(path, "file", error.strerror or "nothing", expected) from None
    except Exception as error:  # trimesh raises whatever its parsers stumble over
        raise BadFile(path, "file", f"no mesh ({error})", expected) from None
    if not len(triangles) or not np.all(np.isfinite(triangles)):
        raise BadFile(path, "file", f"{len(triangles)} triangles", f"{expected} with a body in it")
    return triangles


def _halves(triangles: Array) -> list[Array]:
    """What is below and above the middle of the longest side, clipped; empty halves left out."""
    low, high = triangles.min(axis=(0, 1)), triangles.max(axis=(0, 1))
    axis = int(np.argmax(high - low))
    if high[axis] - low[axis] <= _SMALLEST_CUT:
        return [triangles]
    at = 0.5 * (low[axis] + high[axis])
    return [half for s in (-1.0, 1.0) if len(half := _clipped(triangles, axis, at, s))]


def _clipped(triangles: Array, axis: int, at: float, side: float) -> Array:
    """Triangles on one side of a plane, those that it cuts clipped by it."""
    from trimesh.intersections import slice_faces_plane

    flat = triangles.reshape(-1, 3)
    faces = np.arange(len(flat)).reshape(-1, 3)
    normal, origin = np.zeros(3), np.zeros(3)
    normal[axis], origin[axis] = side, at
    vertices, left, _ = slice_faces_plane(flat, faces, normal, origin)
    return np.asarray(vertices, dtype=np.float64)[left]


def _volume(triangles: Array) -> float:
    """Of the box round them, each side a tenth of a millimetre at least, mm^3."""
    sides = triangles.max(axis=(0, 1)) - triangles.min(axis=(0, 1))
    return float(np.prod(np.maximum(sides, 0.1)))


def _box(low: Array, high: Array, name: str, T_face_mesh: Array, on: str) -> Solid:
    """A box where it stands; rounded outwards to what a program states."""
    low, high = low - 1e-3, high + 1e-3
    middle = T_face_mesh[:3, :3] @ (0.5 * (low + high)) + T_face_mesh[:3, 3]
    half = 0.5 * (high - low) + 1e-3
    x, y, z = (float(v) for v in middle)
    return Solid(
        name=name,
        half_size=(float(half[0]), float(half[1])),
        low=z - float(half[2]),
        high=z + float(half[2]),
        x=x,
        y=y,
        turn=float(np.arctan2(T_face_mesh[1, 0], T_face_mesh[0, 0])),
        on=on,
    )
