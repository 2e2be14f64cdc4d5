"""Triangles of a standard: joined, measured against the exact surfaces, written for viewers.

In: corners and triangles face by face. Out: a `Mesh` whose triangles know their feature, its
figures by two mesh libraries, STL, 3MF and glTF files. No CAD kernel here.
"""

from matstd.cad_out.meshes.mesh import (
    Mesh,
    aspects,
    ball_mesh,
    chord_errors,
    face_areas,
    inner_folds,
    is_watertight,
    joined,
    manifold_volume,
    mesh_volume,
    owners,
    read_stl,
    welded,
    write_stl,
)
from matstd.cad_out.meshes.scene import Piece, write_3mf, write_glb

__all__ = [
    "Mesh",
    "Piece",
    "aspects",
    "ball_mesh",
    "chord_errors",
    "face_areas",
    "inner_folds",
    "is_watertight",
    "joined",
    "manifold_volume",
    "mesh_volume",
    "owners",
    "read_stl",
    "welded",
    "write_3mf",
    "write_glb",
    "write_stl",
]
