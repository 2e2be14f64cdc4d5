"""Parts and measures of the kernel's shapes, and the names of their faces."""

from dataclasses import dataclass
from typing import Any

import numpy as np
from OCP.BRep import BRep_Tool
from OCP.BRepAdaptor import BRepAdaptor_Curve, BRepAdaptor_Surface
from OCP.BRepCheck import BRepCheck_Analyzer
from OCP.BRepGProp import BRepGProp
from OCP.GeomAbs import GeomAbs_SurfaceType
from OCP.GProp import GProp_GProps
from OCP.TopAbs import TopAbs_ShapeEnum
from OCP.TopExp import TopExp_Explorer
from OCP.TopoDS import TopoDS

from matstd.artefact.body import Standard
from matstd.cad_out.details import Details
from matstd.twin.errors import NotBuildable
from matstd.twin.frames import Array

_SAME = 1e-7  # mm: a face lies where it was put


def _properties(integral: Any, shape: Any) -> GProp_GProps:
    """Mass and centre of mass of a shape by one of the kernel's integrals."""
    properties = GProp_GProps()
    integral(shape, properties)
    return properties


def volume(shape: Any) -> float:
    """Volume of a shape, mm^3."""
    return float(_properties(BRepGProp.VolumeProperties_s, shape).Mass())


def parts_of(shape: Any, kind: TopAbs_ShapeEnum, cast: Any) -> list[Any]:
    """Parts of one kind in the kernel's order; an edge appears once for each of its faces."""
    found = []
    explorer = TopExp_Explorer(shape, kind)
    while explorer.More():
        found.append(cast(explorer.Current()))
        explorer.Next()
    return found


def faces_of(shape: Any) -> list[Any]:
    """Faces of a shape in the kernel's order."""
    return parts_of(shape, TopAbs_ShapeEnum.TopAbs_FACE, TopoDS.Face)


def edges_of(shape: Any) -> list[Any]:
    """Edges of a shape, each once."""
    edges = dict.fromkeys(parts_of(shape, TopAbs_ShapeEnum.TopAbs_EDGE, TopoDS.Edge))
    return [edge for edge in edges if not BRep_Tool.Degenerated_s(edge)]


def ends_and_middle(edge: Any) -> Array:
    """Five points along an edge, (5, 3), mm."""
    curve = BRepAdaptor_Curve(edge)
    t = np.linspace(curve.FirstParameter(), curve.LastParameter(), 5)
    return np.array([coordinates(curve.Value(float(at))) for at in t])


def solids_of(shape: Any) -> list[Any]:
    """Solids of a shape."""
    return parts_of(shape, TopAbs_ShapeEnum.TopAbs_SOLID, TopoDS.Solid)


def shells_of(shape: Any) -> list[Any]:
    """Shells of a shape: the outer one of every solid, and one around every closed pocket."""
    return parts_of(shape, TopAbs_ShapeEnum.TopAbs_SHELL, TopoDS.Shell)


def is_valid(shape: Any) -> bool:
    """Whether the kernel finds no fault in topology and geometry."""
    return bool(BRepCheck_Analyzer(shape).IsValid())


def is_closed(shape: Any) -> bool:
    """Whether every shell of the shape is closed."""
    shells = shells_of(shape)
    return bool(shells) and all(bool(BRep_Tool.IsClosed_s(shell)) for shell in shells)


@dataclass(frozen=True, eq=False)
class FaceNaming:
    """What faces are named after."""

    standard: Standard
    details: Details
    surfaces: dict[str, Any]  # the kernel's surfaces of the patches, by name

    @property
    def names(self) -> tuple[str, ...]:
        """All names that faces of the body carry."""
        patches = (patch.name for patch in self.standard.patches)
        holes = [n for hole in self.standard.holes for n in (hole.name, f"{hole.name}_BORE")]
        return (*patches, self.standard.plane.name, *self.details.face_names, *holes)


def named_faces(wanted: FaceNaming, solid: Any) -> dict[str, Any]:
    """Names of the faces that matter, found by the identity or the place of their surface."""
    named: dict[str, Any] = {}
    for face in faces_of(solid):
        name = _spline_name(face, wanted.surfaces) or _elementary_name(face, wanted)
        if name is not None and name in named and name.startswith("FF"):
            raise NotBuildable(f"standard '{wanted.standard.name}': {name} is cut into pieces")
        # Of several pieces of one plane the largest carries the name.
        if name is not None and (name not in named or area(face) > area(named[name])):
            named[name] = face
    missing = sorted(set(wanted.names) - set(named))
    if missing:
        raise NotBuildable(
            f"standard '{wanted.standard.name}': {', '.join(missing)} got lost in the solid"
        )
    return {name: named[name] for name in wanted.names}


def _spline_name(face: Any, surfaces: dict[str, Any]) -> str | None:
    surface = BRep_Tool.Surface_s(face)
    return next((name for name, put_in in surfaces.items() if surface is put_in), None)


def _elementary_name(face: Any, wanted: FaceNaming) -> str | None:
    """Name of a plane, a cylinder or a cone by its place."""
    shape = BRepAdaptor_Surface(face)
    kind = shape.GetType()
    if kind == GeomAbs_SurfaceType.GeomAbs_Plane:
        return _plane_name(face, shape.Plane(), wanted)
    if kind == GeomAbs_SurfaceType.GeomAbs_Cylinder:
        return _hole_name(shape.Cylinder(), wanted)
    if kind == GeomAbs_SurfaceType.GeomAbs_Cone:
        return _seat_name(shape.Cone(), wanted)
    return None


def _plane_name(face: Any, plane: Any, wanted: FaceNaming) -> str | None:
    axis = plane.Axis().Direction()
    normal, place = coordinates(axis), coordinates(plane.Location())
    standard = wanted.standard
    if abs(abs(normal[2]) - 1.0) < 1e-12:
        if abs(place[2] - standard.base.thickness) < _SAME:
            return standard.plane.name
        if abs(place[2]) < _SAME:
            return _pad_name(centre(face), wanted.details)
        return None
    for name in ("DATUM_B", "DATUM_C"):
        side = wanted.details.sides[name]
        out = np.array([*side.normal, 0.0])
        if abs(abs(normal @ out) - 1.0) < 1e-12 and abs(place @ out - side.offset) < _SAME:
            return name
    return None


def _pad_name(place: Array, details: Details) -> str:
    if not details.pads:
        return "SEAT"
    return min(details.pads, key=lambda pad: np.hypot(place[0] - pad.x, place[1] - pad.y)).name


def _hole_name(cylinder: Any, wanted: FaceNaming) -> str | None:
    place = coordinates(cylinder.Location())
    for bore in wanted.details.bores:
        off = np.cross(place - bore.mouth, bore.direction)
        if np.linalg.norm(off) < _SAME and abs(cylinder.Radius() - bore.radius) < _SAME:
            return bore.name
    for hole in wanted.standard.holes:
        if np.hypot(place[0] - hole.x, place[1] - hole.y) < _SAME:
            bored = abs(cylinder.Radius() - hole.bore_radius) < _SAME
            return f"{hole.name}_BORE" if bored else hole.name
    return None


def _seat_name(cone: Any, wanted: FaceNaming) -> str | None:
    """A countersink, which is wider than any post tapers."""
    tip = coordinates(cone.Apex())
    for sphere in wanted.standard.spheres:
        seat = wanted.details.seats[sphere.name]
        if np.linalg.norm(tip - [*sphere.centre[:2], seat.bottom]) < 1e-5:
            return f"{sphere.name}_SEAT"
    return None


def centre(face: Any) -> Array:
    """Centroid of a face, (3,), mm."""
    return coordinates(_properties(BRepGProp.SurfaceProperties_s, face).CentreOfMass())


def area(face: Any) -> float:
    """Area of a face, mm^2."""
    return float(_properties(BRepGProp.SurfaceProperties_s, face).Mass())


def coordinates(p: Any) -> Array:
    """Of a point, vector or direction of the kernel, (3,)."""
    return np.array([p.X(), p.Y(), p.Z()])


def length(edge: Any) -> float:
    """Length of an edge, mm."""
    return float(_properties(BRepGProp.LinearProperties_s, edge).Mass())
