"""STEP files re-read by the kernel, and the triangulation of its solids."""

from dataclasses import dataclass
from functools import partial
from pathlib import Path
from typing import Any

import numpy as np
from OCP.BRep import BRep_Tool
from OCP.BRepAdaptor import BRepAdaptor_Curve, BRepAdaptor_Curve2d, BRepAdaptor_Surface
from OCP.BRepMesh import BRepMesh_IncrementalMesh
from OCP.BRepTools import BRepTools
from OCP.collections import IndexedMap_TopoDS_Shape_TopTools_ShapeMapHasher as IndexedMap
from OCP.GeomAbs import GeomAbs_CurveType, GeomAbs_SurfaceType
from OCP.gp import gp_Pnt
from OCP.IFSelect import IFSelect_ReturnStatus
from OCP.ShapeAnalysis import ShapeAnalysis_Surface
from OCP.STEPCAFControl import STEPCAFControl_Reader
from OCP.STEPControl import STEPControl_Reader
from OCP.TDF import TDF_Label
from OCP.TopAbs import TopAbs_Orientation, TopAbs_ShapeEnum
from OCP.TopExp import TopExp
from OCP.TopLoc import TopLoc_Location
from OCP.TopoDS import TopoDS
from OCP.XCAFDoc import XCAFDoc_DocumentTool, XCAFDoc_ShapeTool
from scipy.interpolate import NdBSpline

from matstd.cad_out.details import Tolerance
from matstd.cad_out.kernel.faces import (
    area,
    coordinates,
    edges_of,
    faces_of,
    is_closed,
    is_valid,
    length,
    parts_of,
    shells_of,
    solids_of,
    volume,
)
from matstd.cad_out.kernel.pmi import notes_of_label, read_signs, read_tolerances
from matstd.cad_out.kernel.xcaf import labels_of, name_of, new_document, settings
from matstd.cad_out.triangles import (
    Chart,
    Edge,
    Face,
    Frame,
    Map,
    Side,
    arc_step,
    bisected,
    cone,
    cylinder,
    plane_chart,
    refined,
    revolved_chart,
    scaled_chart,
    torus,
)
from matstd.twin.errors import NotBuildable
from matstd.twin.frames import Array

_LOOKED_AT = 100  # triangles of a face whose distance is measured
_ANGLE = 0.3  # rad between neighbouring triangles; the chord decides on all but tiny radii


@dataclass(frozen=True, slots=True)
class Reread:
    """What the kernel finds in a STEP file that it has re-read."""

    solids: int  # all of them, instances counted
    is_valid: bool
    is_closed: bool
    shells: int
    volume: float  # of all solids, mm^3
    least_face: float  # area of the smallest face, mm^2
    least_edge: float  # length of the shortest edge, mm
    products: dict[str, int]  # how often each product is there, by name
    names: tuple[str, ...]
    tolerances: tuple[Tolerance, ...]  # geometrical tolerances with their datums
    notes: tuple[str, ...]  # general notes of all parts
    # of what is drawn, the length of its lines and their centre of mass, mm
    signs: dict[str, tuple[float, float, float, float]]


def read_shape(path: Path) -> Any:
    """All that a foreign STEP file draws, as one shape, mm; raises NotBuildable for nothing."""
    reader = STEPControl_Reader()
    if reader.ReadFile(str(path)) != IFSelect_ReturnStatus.IFSelect_RetDone:
        raise NotBuildable("the CAD kernel cannot read it")
    reader.TransferRoots()
    shape = reader.OneShape()
    if shape.IsNull() or not faces_of(shape):
        raise NotBuildable("there is no face in it")
    return shape


def read_step(path: Path) -> Reread:
    """Read a STEP file with a fresh reader and measure its contents."""
    # without this setting the names of faces are not read
    settings({"read.stepcaf.subshapes.name": 1})
    reader = STEPCAFControl_Reader()
    reader.SetNameMode(True)
    reader.SetGDTMode(True)
    reader.SetMetaMode(True)
    if reader.ReadFile(str(path)) != IFSelect_ReturnStatus.IFSelect_RetDone:
        raise NotBuildable(f"{path}: the CAD kernel cannot read its own STEP file")
    document = new_document()
    reader.Transfer(document)
    tool = XCAFDoc_DocumentTool.ShapeTool_s(document.Main())
    wholes = labels_of(tool.GetFreeShapes)
    solids = [s for whole in wholes for s in solids_of(XCAFDoc_ShapeTool.GetShape_s(whole))]
    counted: dict[str, int] = {}
    names: set[str] = set()
    notes: list[str] = []
    for whole in wholes:
        for part in _parts(whole):
            counted[name_of(part)] = counted.get(name_of(part), 0) + 1
            faces = labels_of(partial(XCAFDoc_ShapeTool.GetSubShapes_s, part))
            names |= {name_of(face) for face in faces} - {""}
            notes += notes_of_label(part)
    return Reread(
        solids=len(solids),
        is_valid=all(is_valid(solid) for solid in solids),
        is_closed=all(is_closed(solid) for solid in solids),
        shells=sum(len(shells_of(solid)) for solid in solids),
        volume=sum(volume(solid) for solid in solids),
        least_face=min(area(face) for solid in solids for face in faces_of(solid)),
        least_edge=min(length(edge) for solid in solids for edge in edges_of(solid)),
        products=counted,
        names=tuple(sorted(names)),
        tolerances=tuple(read_tolerances(document)),
        notes=tuple(notes),
        signs=read_signs(document),
    )


def _parts(whole: Any) -> list[Any]:
    """Labels of the parts of an assembly, one for each instance."""
    if not XCAFDoc_ShapeTool.IsAssembly_s(whole):
        return [whole]
    found = []
    for component in labels_of(lambda out: XCAFDoc_ShapeTool.GetComponents_s(whole, out, False)):
        part = TDF_Label()
        XCAFDoc_ShapeTool.GetReferredShape_s(component, part)
        found += _parts(part)
    return found


def tessellate(shape: Any, chord: float) -> tuple[Array, np.ndarray, np.ndarray]:
    """Triangles of a solid as the kernel makes them, face by face and not yet joined.

    Args:
        shape: To be meshed; an older mesh on it is dropped.
        chord: Absolute deflection asked for, mm. It is a request and not a guarantee.

    Returns:
        Corners (V, 3), triangles (F, 3) with outward winding, and for each triangle the index
        of its face in the order of the solid's faces (F,).
    """
    BRepTools.Clean_s(shape)
    # The third argument is "relative": it must be False, or the chord means something else.
    BRepMesh_IncrementalMesh(shape, chord, False, _ANGLE, True)
    corners: list[Array] = []
    triangles: list[np.ndarray] = []
    owners: list[np.ndarray] = []
    count = 0
    for number, face in enumerate(faces_of(shape)):
        location = TopLoc_Location()
        mesh = BRep_Tool.Triangulation_s(face, location)
        if mesh is None:
            raise NotBuildable(f"the CAD kernel left face {number} without triangles")
        points, corner_of = _triangulation(mesh, location)
        if face.Orientation() == TopAbs_Orientation.TopAbs_REVERSED:
            corner_of = corner_of[:, ::-1]
        corners.append(points)
        triangles.append(corner_of + count)
        owners.append(np.full(len(corner_of), number))
        count += len(points)
    return np.concatenate(corners), np.concatenate(triangles), np.concatenate(owners)


def farthest_from_faces(
    shape: Any, corners: Array, triangles: np.ndarray, numbers: np.ndarray
) -> float:
    """Largest distance of a mesh from curved faces of its solid, mm, by the kernel's projection.

    It is measured at the middles of the sides of at most a hundred triangles of every face.

    Args:
        corners: Shape (V, 3), mm.
        triangles: Shape (F, 3).
        numbers: Index of every triangle's face, (F,).
    """
    worst = 0.0
    for number, face in enumerate(faces_of(shape)):
        if BRepAdaptor_Surface(face).GetType() == GeomAbs_SurfaceType.GeomAbs_Plane:
            continue
        mine = triangles[numbers == number]
        some = corners[mine[np.linspace(0, len(mine) - 1, min(len(mine), _LOOKED_AT)).astype(int)]]
        surface = ShapeAnalysis_Surface(BRep_Tool.Surface_s(face))
        for x in (0.5 * (some + np.roll(some, 1, axis=1))).reshape(-1, 3):
            surface.ValueOfUV(gp_Pnt(*map(float, x)), 1e-6)
            worst = max(worst, float(surface.Gap()))
    return worst


def face_numbers(shape: Any, faces: dict[str, Any]) -> dict[str, int]:
    """Index of every named face in the order of a solid's faces."""
    order = faces_of(shape)
    return {
        name: next(i for i, other in enumerate(order) if other.IsSame(face))
        for name, face in faces.items()
    }


def _triangulation(mesh: Any, location: Any) -> tuple[Array, np.ndarray]:
    """Corners in the part's frame, also where the face carries a location of its own."""
    move = location.Transformation()
    points = np.array(
        [
            (p.X(), p.Y(), p.Z())
            for p in (mesh.Node(i).Transformed(move) for i in range(1, mesh.NbNodes() + 1))
        ]
    )
    corner_of = np.array([mesh.Triangle(i).Get() for i in range(1, mesh.NbTriangles() + 1)])
    return points, corner_of - 1


def triangulate(shape: Any, chord: float) -> tuple[Array, np.ndarray, np.ndarray]:
    """Triangles of a solid, joined, without needles.

    Args:
        chord: Largest distance from the surfaces to aim at, mm.

    Returns:
        Corners (V, 3), mm, triangles (F, 3) with outward winding, and for each triangle the
        index of its face in the order of the solid's faces (F,).
    """
    vertices, lines = IndexedMap(), IndexedMap()
    TopExp.MapShapes_s(shape, TopAbs_ShapeEnum.TopAbs_VERTEX, vertices)
    TopExp.MapShapes_s(shape, TopAbs_ShapeEnum.TopAbs_EDGE, lines)
    corners = np.array([coordinates(BRep_Tool.Pnt_s(TopoDS.Vertex(vertex))) for vertex in vertices])
    edges = [_edge(TopoDS.Edge(line), vertices, chord) for line in lines]
    faces = []
    for face in faces_of(shape):
        forward = TopoDS.Face(face.Oriented(TopAbs_Orientation.TopAbs_FORWARD))
        chart = _chart(BRepAdaptor_Surface(forward), chord)
        sides = [
            Side(edge=lines.FindIndex(edge) - 1, at=_places(edge, forward, chart.place))
            for edge in _sides_of(forward)
        ]
        found = Face(
            point=chart.point,
            sides=sides,
            is_flat=chart.is_flat,
            is_reversed=face.Orientation() == TopAbs_Orientation.TopAbs_REVERSED,
            spacing=chart.spacing,
        )
        faces.append(found)
    return refined(corners, edges, faces, chord)


def _sides_of(face: Any) -> list[Any]:
    """Edges of a face, its seam twice, without those that are only a point."""
    edges = parts_of(face, TopAbs_ShapeEnum.TopAbs_EDGE, TopoDS.Edge)
    return [edge for edge in edges if not BRep_Tool.Degenerated_s(edge)]


def _edge(edge: Any, vertices: Any, chord: float) -> Edge:
    """An edge with as many points as the chord asks for; none where it is only a point."""
    ends = TopExp.FirstVertex_s(edge, False), TopExp.LastVertex_s(edge, False)
    first, last = (vertices.FindIndex(vertex) - 1 for vertex in ends)
    if BRep_Tool.Degenerated_s(edge):
        return Edge(at=lambda t: np.empty((0, 3)), t=np.zeros(2), ids=np.array([first, last]))
    curve = BRepAdaptor_Curve(TopoDS.Edge(edge.Oriented(TopAbs_Orientation.TopAbs_FORWARD)))

    def at(t: Array) -> Array:
        return np.array([coordinates(curve.Value(float(v))) for v in t]).reshape(-1, 3)

    low, high = curve.FirstParameter(), curve.LastParameter()
    t = np.array([low, high])
    if curve.GetType() == GeomAbs_CurveType.GeomAbs_Circle:
        steps = int(np.ceil((high - low) / arc_step(curve.Circle().Radius(), chord)))
        t = np.linspace(low, high, max(steps, 1) + 1)
    elif curve.GetType() != GeomAbs_CurveType.GeomAbs_Line:
        t = bisected(at, np.linspace(low, high, 5), chord)
    return Edge(at=at, t=t, ids=np.array([first, *[0] * (len(t) - 2), last]))


def _places(edge: Any, face: Any, place: Map) -> Map:
    """Parameters of an edge to places in the chart of one of its faces."""
    curve = BRepAdaptor_Curve2d(edge, face)

    def at(t: Array) -> Array:
        found = [(p.X(), p.Y()) for p in (curve.Value(float(v)) for v in t)]
        return place(np.array(found).reshape(-1, 2))

    return at


def _chart(surface: Any, chord: float) -> Chart:
    kinds, kind = GeomAbs_SurfaceType, surface.GetType()
    if kind == kinds.GeomAbs_Plane:
        return plane_chart(_frame(surface.Plane().Position()))
    low = np.array([surface.FirstUParameter(), surface.FirstVParameter()])
    high = np.array([surface.LastUParameter(), surface.LastVParameter()])
    if kind == kinds.GeomAbs_Cylinder:
        shape = surface.Cylinder()
        profile = cylinder(shape.Radius())
    elif kind == kinds.GeomAbs_Cone:
        shape = surface.Cone()
        profile = cone(shape.RefRadius(), shape.SemiAngle())
    elif kind == kinds.GeomAbs_Torus:
        shape = surface.Torus()
        profile = torus(shape.MajorRadius(), shape.MinorRadius())
    else:
        return scaled_chart(_in_space(surface), low, high)
    return revolved_chart(_frame(shape.Position()), profile, low, high, chord)


def _frame(position: Any) -> Frame:
    x, y, z = position.XDirection(), position.YDirection(), position.Direction()
    return Frame(
        x=coordinates(x),
        y=coordinates(y),
        z=coordinates(z),
        origin=coordinates(position.Location()),
    )


def _in_space(surface: Any) -> Map:
    """Parameters of a surface to points; a spline is evaluated at many places at once."""
    is_spline = surface.GetType() == GeomAbs_SurfaceType.GeomAbs_BSplineSurface
    spline = surface.BSpline() if is_spline else None
    if spline is not None and not (spline.IsUPeriodic() or spline.IsVPeriodic()):
        each = [
            (i, j) for i in range(1, spline.NbUPoles() + 1) for j in range(1, spline.NbVPoles() + 1)
        ]
        weight = np.array([[spline.Weight(*ij)] for ij in each])  # of a rational one
        poles = np.hstack(
            [np.array([coordinates(spline.Pole(*ij)) for ij in each]) * weight, weight]
        )
        knots = _knots(spline, "U"), _knots(spline, "V")
        net = poles.reshape(spline.NbUPoles(), spline.NbVPoles(), 4)
        at = NdBSpline(knots, net, (spline.UDegree(), spline.VDegree()))

        def at_once(uv: Array) -> Array:
            found = at(uv)
            return np.asarray(found[:, :3] / found[:, 3:])

        return at_once

    def one_by_one(uv: Array) -> Array:
        found = [coordinates(surface.Value(float(u), float(v))) for u, v in uv]
        return np.array(found).reshape(-1, 3)

    return one_by_one


def _knots(spline: Any, axis: str) -> Array:
    """Knots of a spline, repeated by their multiplicities."""
    number = range(1, getattr(spline, f"Nb{axis}Knots")() + 1)
    knot, times = getattr(spline, f"{axis}Knot"), getattr(spline, f"{axis}Multiplicity")
    return np.repeat([knot(i) for i in number], [times(i) for i in number])
