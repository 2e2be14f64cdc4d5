"""Triangles of the standard: joined to a closed mesh, measured against the exact surfaces."""

from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from artefact.body import DatumSphere, FreeformPatch, Standard
from twin.frames import Array, apply

WELD = 1e-6
"""Corners nearer than this are one corner, mm."""

_ON_SURFACE = 0.1  # mm, coarser than any mesh made here
_ALIKE = 0.9  # cosine between a triangle's and a surface's normal

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
    """A triangle mesh whose triangles know their face.

    Attributes:
        corners: Shape (V, 3), mm.
        triangles: Indices into the corners, outward winding, shape (F, 3).
        owner: Name of the feature of each triangle, (F,); empty for the rest of the body.
    """

    corners: Array
    triangles: np.ndarray
    owner: np.ndarray


def welded(corners: Array, triangles: np.ndarray, owner: np.ndarray) -> Mesh:
    """Join the corners of neighbouring faces and drop what collapses.

    Args:
        corners: Shape (V, 3), mm, float64: rounding them would part corners at the ties.
        triangles: Shape (F, 3).
        owner: Shape (F,).

    Returns:
        One mesh, closed if the faces were.
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


def write_stl(path: Path, mesh: Mesh) -> None:
    """Binary STL, the same bytes for the same mesh."""
    path.write_bytes(_trimesh(mesh.corners, mesh.triangles).export(file_type="stl"))


def read_stl(path: Path) -> tuple[Array, np.ndarray]:
    """Corners (V, 3) and triangles (F, 3) of an STL file, equal corners joined, order kept."""
    import trimesh

    loaded = trimesh.load_mesh(str(path), file_type="stl", process=False)
    corners, back = np.unique(np.asarray(loaded.vertices), axis=0, return_inverse=True)
    return corners, back.reshape(-1)[np.asarray(loaded.faces)]


def is_watertight(corners: Array, triangles: np.ndarray) -> bool:
    """Whether every edge has two triangles of consistent winding, by trimesh."""
    mesh = _trimesh(corners, triangles)
    return bool(mesh.is_watertight and mesh.is_winding_consistent and mesh.volume > 0.0)


def manifold_volume(corners: Array, triangles: np.ndarray) -> float:
    """Volume by manifold3d, mm^3; nan where it does not accept the mesh as a solid."""
    import manifold3d

    solid = manifold3d.Manifold(
        manifold3d.Mesh(
            vert_properties=np.ascontiguousarray(corners, dtype=np.float32),
            tri_verts=np.ascontiguousarray(triangles, dtype=np.uint32),
        )
    )
    accepted = solid.status() == manifold3d.Error.NoError and not solid.is_empty()
    return float(solid.volume()) if accepted else float("nan")


def mesh_volume(corners: Array, triangles: np.ndarray) -> float:
    """Volume by the divergence theorem, ``sum a . (b x c) / 6``, mm^3."""
    a, b, c = (corners[triangles[:, k]] for k in range(3))
    return float(np.einsum("ni,ni->", a, np.cross(b, c)) / 6.0)


def chord_errors(
    standard: Standard, corners: Array, triangles: np.ndarray, owner: np.ndarray
) -> dict[str, float]:
    """Largest distance of the triangles of every patch and sphere from the exact surface.

    For a patch the distance is ``(z - h) cos(slope)``, right to first order in itself.

    Args:
        standard: With the exact surfaces.
        corners: Shape (V, 3), mm.
        triangles: Shape (F, 3).
        owner: Name of each triangle's feature, (F,).

    Returns:
        Distance by feature name, mm; infinite where a feature has no triangle at all.
    """
    errors = {}
    surfaces: tuple[FreeformPatch | DatumSphere, ...] = (*standard.patches, *standard.spheres)
    for surface in surfaces:
        mine = corners[triangles[owner == surface.name]]  # (F, 3, 3)
        if not len(mine):
            errors[surface.name] = np.inf
            continue
        points = np.einsum("lk,fki->fli", _LATTICE, mine).reshape(-1, 3)
        errors[surface.name] = float(np.abs(_distance(surface, points)).max())
    return errors


def face_areas(corners: Array, triangles: np.ndarray, owner: np.ndarray) -> dict[str, float]:
    """Area of the triangles of every named feature, mm^2."""
    a, b, c = (corners[triangles[:, k]] for k in range(3))
    area = 0.5 * np.linalg.norm(np.cross(b - a, c - a), axis=1)
    return {str(name): float(area[owner == name].sum()) for name in np.unique(owner) if name}


def owners(standard: Standard, corners: Array, triangles: np.ndarray) -> np.ndarray:
    """Feature of every triangle of a mesh that has lost its faces, as one from an STL file.

    A triangle belongs to a patch or a sphere if its middle lies on the surface and it looks the
    same way.

    Args:
        standard: With the exact surfaces.
        corners: Shape (V, 3), mm.
        triangles: Shape (F, 3).

    Returns:
        Names, (F,); empty for the rest of the body.
    """
    a, b, c = (corners[triangles[:, k]] for k in range(3))
    middle, across = (a + b + c) / 3.0, np.cross(b - a, c - a)
    facing = across / np.maximum(np.linalg.norm(across, axis=1), 1e-300)[:, None]
    owner = np.full(len(triangles), "", dtype="<U32")
    surfaces: tuple[FreeformPatch | DatumSphere, ...] = (*standard.patches, *standard.spheres)
    for surface in surfaces:
        near = np.flatnonzero(np.abs(_distance(surface, middle)) < _ON_SURFACE)
        if isinstance(surface, FreeformPatch):
            # So near the face the foot point is next to the point straight below.
            uv = apply(surface.T_patch_artefact, middle[near])[:, :2]
            near, uv = near[surface.contains(uv)], uv[surface.contains(uv)]
        else:
            uv = surface.project(middle[near])
        alike = np.einsum("ni,ni->n", facing[near], surface.normal(uv)) > _ALIKE
        owner[near[alike]] = surface.name
    return owner


def _distance(surface: FreeformPatch | DatumSphere, points: Array) -> Array:
    if isinstance(surface, DatumSphere):
        distance: Array = np.linalg.norm(points - surface.centre, axis=1) - surface.radius
        return distance
    local = apply(surface.T_patch_artefact, points)
    j = surface.jet(local[:, :2])
    return (local[:, 2] - j.h) / np.sqrt(1.0 + j.hu**2 + j.hv**2)


def _trimesh(corners: Array, triangles: np.ndarray) -> Any:
    import trimesh

    return trimesh.Trimesh(vertices=corners, faces=triangles, process=False)
