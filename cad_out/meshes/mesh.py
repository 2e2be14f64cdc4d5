"""Triangles of the standard: joined to a closed mesh, measured against the exact surfaces."""

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from matstd.artefact.body import DatumSphere, FreeformPatch, Standard
from matstd.artefact.seat import manifold
from matstd.twin.frames import Array, apply
from matstd.twin.numbers import distinct_rows

WELD = 1e-6  # corners nearer than this are one corner, mm
_ON_SURFACE = 0.1  # mm, coarser than any mesh made here
_SAME_NORMAL_COSINE = 0.9  # cosine between a triangle's and a surface's normal

# Where the distance of a triangle from its surface is measured: corners of a lattice of order 4
# without the triangle's own corners, which the kernel puts on the surface.
_LATTICE = (
    np.array(
        [(i, j, 4 - i - j) for i in range(5) for j in range(5 - i) if max(i, j, 4 - i - j) < 4]
    )
    / 4.0
)


@dataclass(frozen=True, eq=False)
class Mesh:
    """A triangle mesh whose triangles know their face."""

    corners: Array  # shape (V, 3), mm
    triangles: np.ndarray  # indices into the corners, outward winding, shape (F, 3)
    owner: np.ndarray  # name of the feature of each triangle, (F,); empty for the rest of the body

    def of(self, which: np.ndarray) -> "Mesh":
        """Some triangles with the corners that they have."""
        used, back = np.unique(self.triangles[which], return_inverse=True)
        return Mesh(self.corners[used], back.reshape(-1, 3), self.owner[which])


def welded(corners: Array, triangles: np.ndarray, owner: np.ndarray) -> Mesh:
    """Join the corners of neighbouring faces and drop triangles that collapse.

    Args:
        corners: Shape (V, 3), mm, float64: rounding them would part corners at the ties.
        triangles: Shape (F, 3).
    """
    from scipy.sparse import coo_array
    from scipy.sparse.csgraph import connected_components
    from scipy.spatial import cKDTree

    pairs = cKDTree(corners).query_pairs(WELD, output_type="ndarray")
    links = coo_array(
        (np.ones(len(pairs), dtype=bool), (pairs[:, 0], pairs[:, 1])), shape=(len(corners),) * 2
    )
    _, group = connected_components(links, directed=False)
    _, first = np.unique(group, return_index=True)
    joined = group[triangles]
    a, b, c = joined.T
    whole = (a != b) & (b != c) & (c != a)
    return Mesh(corners[first], joined[whole], owner[whole])


def ball_mesh(sphere: DatumSphere, chord: float) -> Mesh:
    """A ball of nearly equal triangles, at most `chord` (mm) from it: an icosahedron, cut finer."""
    corners, faces = _icosahedron()
    # the middle of a triangle of edge e lies e^2 / 6 R below; the largest is a fifth wider
    edge = np.sqrt(6.0 * sphere.radius * chord) / 1.25
    side = sphere.radius * np.linalg.norm(np.subtract(*corners[faces[0, :2]]))
    n = max(int(np.ceil(side / edge)), 2)
    lattice = [(i, j) for i in range(n + 1) for j in range(n + 1 - i)]
    at = {place: k for k, place in enumerate(lattice)}
    up = [(at[i, j], at[i + 1, j], at[i, j + 1]) for i, j in lattice if i + j < n]
    down = [(at[i + 1, j], at[i + 1, j + 1], at[i, j + 1]) for i, j in lattice if i + j < n - 1]
    share = np.array([(n - i - j, i, j) for i, j in lattice]) / n
    points = np.einsum("lk,fki->fli", share, corners[faces])
    points = points / np.linalg.norm(points, axis=-1, keepdims=True)
    triangles = np.array(up + down) + len(lattice) * np.arange(len(faces))[:, None, None]
    flat = triangles.reshape(-1, 3)
    where = sphere.centre + sphere.radius * points.reshape(-1, 3)
    return welded(where, flat, np.full(len(flat), sphere.name))


def _icosahedron() -> tuple[Array, np.ndarray]:
    """Corners (12, 3) on the unit ball, faces (20, 3) with outward winding."""
    from scipy.spatial import ConvexHull

    golden = 0.5 * (1.0 + np.sqrt(5.0))
    corners = np.array(
        [
            np.roll([0.0, s, t * golden], shift)
            for shift in range(3)
            for s in (-1.0, 1.0)
            for t in (-1.0, 1.0)
        ]
    )
    faces = np.sort(ConvexHull(corners).simplices, axis=1)
    faces = faces[np.lexsort(faces.T[::-1])]
    a, b, c = (corners[faces[:, k]] for k in range(3))
    inwards = np.einsum("ni,ni->n", np.cross(b - a, c - a), a) < 0.0
    faces[inwards] = faces[inwards][:, ::-1]
    return corners / np.linalg.norm(corners[0]), faces


def joined(meshes: Sequence[Mesh]) -> Mesh:
    """Several meshes as one, each a shell of its own."""
    before = np.cumsum([0, *(len(mesh.corners) for mesh in meshes)])
    return Mesh(
        np.concatenate([mesh.corners for mesh in meshes]),
        np.concatenate([m.triangles + k for m, k in zip(meshes, before, strict=False)]),
        np.concatenate([mesh.owner for mesh in meshes]),
    )


def write_stl(path: Path, mesh: Mesh) -> None:
    """Binary STL, the same bytes for the same mesh."""
    path.write_bytes(_trimesh(mesh.corners, mesh.triangles).export(file_type="stl"))


def read_stl(path: Path) -> tuple[Array, np.ndarray]:
    """Corners (V, 3) and triangles (F, 3) of an STL file, equal corners joined, order kept."""
    import trimesh

    loaded = trimesh.load_mesh(str(path), file_type="stl", process=False)
    corners, back = distinct_rows(loaded.triangles.reshape(-1, 3))
    return corners, back.reshape(-1, 3)


def is_watertight(corners: Array, triangles: np.ndarray) -> bool:
    """Whether every edge has two triangles of consistent winding, by trimesh."""
    mesh = _trimesh(corners, triangles)
    return bool(mesh.is_watertight and mesh.is_winding_consistent and mesh.volume > 0.0)


def manifold_volume(corners: Array, triangles: np.ndarray) -> float:
    """Volume by manifold3d, mm^3; nan where it does not accept the mesh as a solid."""
    import manifold3d

    solid = manifold(corners, triangles)
    accepted = solid.status() == manifold3d.Error.NoError and not solid.is_empty()
    return float(solid.volume()) if accepted else float("nan")


def mesh_volume(corners: Array, triangles: np.ndarray) -> float:
    """Volume by the divergence theorem, ``sum a . (b x c) / 6``, mm^3."""
    a, b, c = (corners[triangles[:, k]] for k in range(3))
    return float(np.einsum("ni,ni->", a, np.cross(b, c)) / 6.0)


def chord_errors(standard: Standard, mesh: Mesh) -> dict[str, float]:
    """Largest distance of the triangles of every patch and sphere from the exact surface.

    For a patch the distance is ``(z - h) cos(slope)`` with the slope of the triangle, right to
    first order in itself; the surface's own slope would take four times as long.

    Returns:
        Distance by feature name, mm; infinite where a feature has no triangle at all.
    """
    errors = {}
    surfaces: tuple[FreeformPatch | DatumSphere, ...] = (*standard.patches, *standard.spheres)
    for surface in surfaces:
        mine = mesh.corners[mesh.triangles[mesh.owner == surface.name]]  # (F, 3, 3)
        if not len(mine):
            errors[surface.name] = np.inf
            continue
        points = np.einsum("lk,fki->fli", _LATTICE, mine)
        if isinstance(surface, FreeformPatch):
            off = _above(surface, points) * np.abs(_normals(mine) @ surface.direction)[:, None]
        else:
            off = _distance(surface, points.reshape(-1, 3))
        errors[surface.name] = float(np.abs(off).max())
    return errors


def _above(patch: FreeformPatch, points: Array) -> Array:
    """Height of points (..., 3) over a patch along its own direction, mm."""
    local = apply(patch.T_patch_artefact, points.reshape(-1, 3))
    return (local[:, 2] - patch.height(local[:, :2])).reshape(points.shape[:-1])


def _normals(corner: Array) -> Array:
    """Unit normals of triangles (F, 3, 3); zero where a triangle has no area."""
    across = np.cross(corner[:, 1] - corner[:, 0], corner[:, 2] - corner[:, 0])
    length = np.linalg.norm(across, axis=1)
    return np.asarray(across / np.maximum(length, 1e-300)[:, None])


def inner_folds(corners: Array, triangles: np.ndarray, least: float) -> tuple[Array, Array]:
    """Middles (E, 3) and lengths (E,) of edges at which a mesh is folded inwards by an angle, mm.

    Args:
        corners: Shape (V, 3), mm.
        triangles: Shape (F, 3).
        least: Angle between the normals of two triangles, rad.
    """
    mesh = _trimesh(corners, triangles)
    folded = ~mesh.face_adjacency_convex & (mesh.face_adjacency_angles > least)
    begin, end = np.swapaxes(corners[mesh.face_adjacency_edges[folded]], 0, 1)
    return 0.5 * (begin + end), np.linalg.norm(end - begin, axis=1)


def aspects(corners: Array, triangles: np.ndarray) -> Array:
    """Longest side of every triangle over the height on it, (F,): 1.15 if all sides are equal."""
    a, b, c = (corners[triangles[:, k]] for k in range(3))
    longest = np.max([((a - b) ** 2).sum(1), ((b - c) ** 2).sum(1), ((c - a) ** 2).sum(1)], axis=0)
    twice = np.linalg.norm(np.cross(b - a, c - a), axis=1)
    return longest / np.maximum(twice, 1e-300)


def face_areas(mesh: Mesh) -> dict[str, float]:
    """Area of the triangles of every named feature, mm^2."""
    a, b, c = (mesh.corners[mesh.triangles[:, k]] for k in range(3))
    area = 0.5 * np.linalg.norm(np.cross(b - a, c - a), axis=1)
    names = np.unique(mesh.owner)
    return {str(name): float(area[mesh.owner == name].sum()) for name in names if name}


def owners(standard: Standard, corners: Array, triangles: np.ndarray) -> np.ndarray:
    """Feature of every triangle of a mesh without faces, as from an STL file, (F,); empty for none.

    A triangle belongs to a patch or a sphere if its middle lies on the surface and it looks the
    same way.

    Args:
        corners: Shape (V, 3), mm.
        triangles: Shape (F, 3).
    """
    a, b, c = (corners[triangles[:, k]] for k in range(3))
    middle, facing = (a + b + c) / 3.0, _normals(corners[triangles])
    owner = np.full(len(triangles), "", dtype="<U32")
    surfaces: tuple[FreeformPatch | DatumSphere, ...] = (*standard.patches, *standard.spheres)
    for surface in surfaces:
        near = np.arange(len(middle))
        if isinstance(surface, FreeformPatch):
            # So near the face the foot point is next to the point straight below.
            near = near[surface.contains(apply(surface.T_patch_artefact, middle)[:, :2])]
        near = near[np.abs(_distance(surface, middle[near])) < _ON_SURFACE]
        if isinstance(surface, FreeformPatch):
            uv = apply(surface.T_patch_artefact, middle[near])[:, :2]
        else:
            uv = surface.project(middle[near])
        alike = np.einsum("ni,ni->n", facing[near], surface.normal(uv)) > _SAME_NORMAL_COSINE
        owner[near[alike]] = surface.name
    return owner


def _distance(surface: FreeformPatch | DatumSphere, points: Array) -> Array:
    if isinstance(surface, DatumSphere):
        return np.linalg.norm(points - surface.centre, axis=1) - surface.radius
    local = apply(surface.T_patch_artefact, points)
    j = surface.jet(local[:, :2])
    return (local[:, 2] - j.h) / np.sqrt(1.0 + j.hu**2 + j.hv**2)


def _trimesh(corners: Array, triangles: np.ndarray) -> Any:
    import trimesh

    return trimesh.Trimesh(vertices=corners, faces=triangles, process=False)
