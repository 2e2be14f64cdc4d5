"""Questions to the kernel about a shape, and the names of its faces."""

from typing import Any

import numpy as np
from OCP.BRep import BRep_Tool
from OCP.BRepAdaptor import BRepAdaptor_Surface
from OCP.BRepCheck import BRepCheck_Analyzer
from OCP.BRepGProp import BRepGProp
from OCP.GeomAbs import GeomAbs_SurfaceType
from OCP.GProp import GProp_GProps
from OCP.TopAbs import TopAbs_ShapeEnum
from OCP.TopExp import TopExp_Explorer
from OCP.TopoDS import TopoDS

from artefact.body import Standard
from twin.errors import NotBuildable
from twin.frames import Array

_SAME = 1e-7  # mm: a face lies where it was put


def volume(shape: Any) -> float:
    """Volume of a shape, mm^3."""
    properties = GProp_GProps()
    BRepGProp.VolumeProperties_s(shape, properties)
    return float(properties.Mass())


def faces_of(shape: Any) -> list[Any]:
    """Faces of a shape in the kernel's order."""
    found = []
    explorer = TopExp_Explorer(shape, TopAbs_ShapeEnum.TopAbs_FACE)
    while explorer.More():
        found.append(TopoDS.Face(explorer.Current()))
        explorer.Next()
    return found


def solids_of(shape: Any) -> list[Any]:
    """Solids of a shape."""
    found = []
    explorer = TopExp_Explorer(shape, TopAbs_ShapeEnum.TopAbs_SOLID)
    while explorer.More():
        found.append(TopoDS.Solid(explorer.Current()))
        explorer.Next()
    return found


def shells_of(shape: Any) -> list[Any]:
    """Shells of a shape: the outer one of every solid, and one around every closed pocket."""
    found = []
    explorer = TopExp_Explorer(shape, TopAbs_ShapeEnum.TopAbs_SHELL)
    while explorer.More():
        found.append(TopoDS.Shell(explorer.Current()))
        explorer.Next()
    return found


def is_valid(shape: Any) -> bool:
    """Whether the kernel finds no fault in topology and geometry."""
    return bool(BRepCheck_Analyzer(shape).IsValid())


def is_closed(shape: Any) -> bool:
    """Whether every shell of the shape is closed."""
    shells = shells_of(shape)
    return bool(shells) and all(bool(BRep_Tool.IsClosed_s(shell)) for shell in shells)


def named_faces(standard: Standard, solid: Any, surfaces: dict[str, Any]) -> dict[str, Any]:
    """Names of the faces that matter, found by the identity or the place of their surface."""
    named: dict[str, Any] = {}
    for face in faces_of(solid):
        name = _spline_name(face, surfaces) or _elementary_name(face, standard)
        if name is not None and name in named and name[:2] in ("FF", "SP"):
            raise NotBuildable(f"standard '{standard.name}': {name} is cut into several faces")
        # Of several pieces of one plane the largest carries the name.
        if name is not None and (name not in named or _area(face) > _area(named[name])):
            named[name] = face
    missing = sorted(set(standard.face_names) - set(named))
    if missing:
        raise NotBuildable(
            f"standard '{standard.name}': {', '.join(missing)} got lost in the solid"
        )
    return {name: named[name] for name in standard.face_names}


def _spline_name(face: Any, surfaces: dict[str, Any]) -> str | None:
    surface = BRep_Tool.Surface_s(face)
    return next((name for name, put_in in surfaces.items() if surface is put_in), None)


def _elementary_name(face: Any, standard: Standard) -> str | None:
    """Name of a sphere, a horizontal plane or a cylinder of a hole by its place."""
    shape = BRepAdaptor_Surface(face)
    kind = shape.GetType()
    if kind == GeomAbs_SurfaceType.GeomAbs_Sphere:
        return _sphere_name(shape.Sphere(), standard)
    if kind == GeomAbs_SurfaceType.GeomAbs_Plane:
        return _plane_name(shape.Plane(), standard)
    if kind == GeomAbs_SurfaceType.GeomAbs_Cylinder:
        return _hole_name(shape.Cylinder(), standard)
    return None


def _sphere_name(ball: Any, standard: Standard) -> str | None:
    centre = _coordinates(ball.Location())
    matches = (s.name for s in standard.spheres if np.abs(centre - s.centre).max() < _SAME)
    return next(matches, None)


def _plane_name(plane: Any, standard: Standard) -> str | None:
    if abs(abs(plane.Axis().Direction().Z()) - 1.0) > 1e-12:
        return None
    height = plane.Location().Z()
    places = {"SEAT": 0.0, standard.plane.name: standard.base.thickness}
    return next((name for name, z in places.items() if abs(height - z) < _SAME), None)


def _hole_name(cylinder: Any, standard: Standard) -> str | None:
    centre = _coordinates(cylinder.Location())
    for hole in standard.holes:
        if np.hypot(centre[0] - hole.x, centre[1] - hole.y) < _SAME:
            bored = abs(cylinder.Radius() - hole.bore_radius) < _SAME
            return f"{hole.name}_BORE" if bored else hole.name
    return None


def _area(face: Any) -> float:
    properties = GProp_GProps()
    BRepGProp.SurfaceProperties_s(face, properties)
    return float(properties.Mass())


def _coordinates(p: Any) -> Array:
    return np.array([p.X(), p.Y(), p.Z()])
