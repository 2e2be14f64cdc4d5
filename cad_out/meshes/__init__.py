"""Triangles of a standard: joined, measured against the exact surfaces, written for viewers.

In: corners and triangles face by face. Out: a `Mesh` whose triangles know their feature, its
figures by two mesh libraries, STL, 3MF and glTF files. No CAD kernel here.
"""

from matstd.cad_out.meshes.mesh import Mesh as Mesh
from matstd.cad_out.meshes.mesh import aspects as aspects
from matstd.cad_out.meshes.mesh import ball_mesh as ball_mesh
from matstd.cad_out.meshes.mesh import chord_errors as chord_errors
from matstd.cad_out.meshes.mesh import face_areas as face_areas
from matstd.cad_out.meshes.mesh import inner_folds as inner_folds
from matstd.cad_out.meshes.mesh import is_watertight as is_watertight
from matstd.cad_out.meshes.mesh import joined as joined
from matstd.cad_out.meshes.mesh import manifold_volume as manifold_volume
from matstd.cad_out.meshes.mesh import mesh_volume as mesh_volume
from matstd.cad_out.meshes.mesh import owners as owners
from matstd.cad_out.meshes.mesh import read_stl as read_stl
from matstd.cad_out.meshes.mesh import welded as welded
from matstd.cad_out.meshes.mesh import write_stl as write_stl
from matstd.cad_out.meshes.scene import Piece as Piece
from matstd.cad_out.meshes.scene import write_3mf as write_3mf
from matstd.cad_out.meshes.scene import write_glb as write_glb
