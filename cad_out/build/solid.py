"""The standard as one boundary-representation solid, faces found by the surfaces put in."""

from dataclasses import dataclass
from typing import Any

import numpy as np
from OCP.BRepAlgoAPI import BRepAlgoAPI_Common, BRepAlgoAPI_Cut, BRepAlgoAPI_Fuse
from OCP.BRepBuilderAPI import (
    BRepBuilderAPI_MakeEdge,
    BRepBuilderAPI_MakeFace,
    BRepBuilderAPI_MakeSolid,
    BRepBuilderAPI_MakeWire,
)
from OCP.BRepClass3d import BRepClass3d
from OCP.BRepPrimAPI import (
    BRepPrimAPI_MakeBox,
    BRepPrimAPI_MakeCone,
    BRepPrimAPI_MakeCylinder,
    BRepPrimAPI_MakePrism,
    BRepPrimAPI_MakeSphere,
)
from OCP.collections import Array1_double, Array1_int, Array2_gp_Pnt, List_TopoDS_Shape
from OCP.Geom import Geom_BSplineSurface
from OCP.gp import gp_Ax2, gp_Circ, gp_Dir, gp_Pnt, gp_Vec
from OCP.ShapeCustom import ShapeCustom
from OCP.ShapeUpgrade import ShapeUpgrade_UnifySameDomain

from artefact.body import Base, DatumSphere, FreeformPatch, MountingHole, Standard
from cad_out.build.faces import is_valid, named_faces, shells_of, solids_of, volume
from twin.errors import NotBuildable
from twin.frames import Array, apply

_FACE_TOLERANCE = 1e-7  # mm, of the kernel's own edges
_SAME = 1e-7  # mm: two points or radii are one
_ROOT = 2.0  # mm a stem goes on into the base, so that no two faces coincide


@dataclass(frozen=True, slots=True)
class Solid:
    """A finished solid of the kernel.

    Attributes:
        shape: The solid.
        faces: Named faces: FF1 ..., SPH1 ..., DATUM_A, SEAT, bores and holes.
        volume: In mm^3.
    """

    shape: Any
    faces: dict[str, Any]
    volume: float


def build_solid(standard: Standard) -> Solid:
    """One valid closed solid: columns, one fuse, one cut, faces named by identity.

    Every column is the prism of its spline face (6 mm larger than the pad) cut out by the pad's
    own box, so its walls are planes and its lid is the spline itself, not an approximation.

    Returns:
        The solid with its named faces.

    Raises:
        NotBuildable: The kernel's result is not one valid solid, or has lost a face.
    """
    surfaces = {patch.name: spline_surface(patch) for patch in standard.patches}
    parts = [_column(patch, surfaces[patch.name], standard.base) for patch in standard.patches]
    parts += [_stem(sphere) for sphere in standard.spheres]
    parts += [_ball(sphere) for sphere in standard.spheres]
    if standard.core is not None:
        parts.append(
            _cone(
                0.0,
                0.0,
                0.5 * standard.base.thickness,
                standard.core.height,
                standard.core.low_radius,
                standard.core.high_radius,
            )
        )
    body = _boolean(BRepAlgoAPI_Fuse(), [_plate(standard.base)], parts, "joining the columns")
    tools = [tool for hole in standard.holes for tool in _hole(hole, standard.base)]
    if tools:
        body = _boolean(BRepAlgoAPI_Cut(), [body], tools, "drilling the holes")
    merged = ShapeUpgrade_UnifySameDomain(body, True, True, False)
    merged.Build()
    # Faces on left-handed or located primitives would lose their names in the STEP file.
    solid = _only_solid(ShapeCustom.DirectFaces_s(merged.Shape()), standard.name)
    return Solid(solid, named_faces(standard, solid, surfaces), volume(solid))


def spline_surface(patch: FreeformPatch) -> Any:
    """The patch's B-spline as the kernel's surface, from its own poles and knots: no fit."""
    poles = patch.poles
    net = Array2_gp_Pnt(1, poles.shape[0], 1, poles.shape[1])
    for i in range(poles.shape[0]):
        for j in range(poles.shape[1]):
            net.SetValue(i + 1, j + 1, gp_Pnt(*map(float, poles[i, j])))
    knots_u, counts_u = _knot_arrays(patch.knots_u)
    knots_v, counts_v = _knot_arrays(patch.knots_v)
    return Geom_BSplineSurface(
        net, knots_u, knots_v, counts_u, counts_v, *patch.degree, False, False
    )


def _knot_arrays(knots: Array) -> tuple[Any, Any]:
    values, counts = np.unique(knots, return_counts=True)
    distinct, multiplicity = Array1_double(1, len(values)), Array1_int(1, len(values))
    for k, (value, count) in enumerate(zip(values, counts, strict=True), 1):
        distinct.SetValue(k, float(value))
        multiplicity.SetValue(k, int(count))
    return distinct, multiplicity


def _column(patch: FreeformPatch, surface: Any, base: Base) -> Any:
    """Prism of the face, trimmed by the pad's box and cut off in mid-base if it gets there."""
    face = BRepBuilderAPI_MakeFace(surface, _FACE_TOLERANCE).Face()
    span = float(patch.heights.max() - patch.heights.min())
    back = -(patch.depth + span + 10.0) * patch.direction
    prism = BRepPrimAPI_MakePrism(face, gp_Vec(*map(float, back))).Shape()
    a, b = patch.half_size
    T = patch.T_artefact_patch
    corner = T[:3, 3] - a * T[:3, 0] - b * T[:3, 1] - patch.depth * T[:3, 2]
    frame = gp_Ax2(_point(corner), _direction(T[:3, 2]), _direction(T[:3, 0]))
    height = patch.depth + float(patch.heights.max()) + 5.0
    box = BRepPrimAPI_MakeBox(frame, 2.0 * a, 2.0 * b, height).Shape()
    column = _boolean(BRepAlgoAPI_Common(), [prism], [box], f"trimming {patch.name}")
    end = [[x, y, -patch.depth] for x in (-a, a) for y in (-b, b)]
    if apply(T, np.array(end))[:, 2].min() > 0.5 * base.thickness:
        return column
    far = 1000.0
    above = BRepPrimAPI_MakeBox(
        gp_Pnt(-far, -far, 0.5 * base.thickness), 2.0 * far, 2.0 * far, far
    ).Shape()
    return _boolean(BRepAlgoAPI_Common(), [column], [above], f"cutting off {patch.name}")


def _plate(base: Base) -> Any:
    """The base: an extruded rectangle with rounded corners, down to a disc."""
    a, b = base.half_size
    r = base.corner_radius
    wire = BRepBuilderAPI_MakeWire()
    corners = ((a - r, b - r, 0), (r - a, b - r, 1), (r - a, r - b, 2), (a - r, r - b, 3))
    starts: list[tuple[float, float]] = []
    ends: list[tuple[float, float]] = []
    for x, y, quarter in corners:
        angle = quarter * np.pi / 2.0
        for points, turned in ((starts, angle), (ends, angle + np.pi / 2.0)):
            points.append((x + r * np.cos(turned), y + r * np.sin(turned)))
    for k, (x, y, _) in enumerate(corners):
        circle = gp_Circ(gp_Ax2(gp_Pnt(x, y, 0.0), gp_Dir(0.0, 0.0, 1.0)), r)
        start, end = gp_Pnt(*starts[k], 0.0), gp_Pnt(*ends[k], 0.0)
        wire.Add(BRepBuilderAPI_MakeEdge(circle, start, end).Edge())
        following = starts[(k + 1) % 4]
        if np.hypot(following[0] - ends[k][0], following[1] - ends[k][1]) > _SAME:
            wire.Add(BRepBuilderAPI_MakeEdge(end, gp_Pnt(*following, 0.0)).Edge())
    outline = BRepBuilderAPI_MakeFace(wire.Wire()).Face()
    return BRepPrimAPI_MakePrism(outline, gp_Vec(0.0, 0.0, base.thickness)).Shape()


def _cone(
    x: float, y: float, low: float, high: float, low_radius: float, high_radius: float
) -> Any:
    axis = gp_Ax2(gp_Pnt(float(x), float(y), float(low)), gp_Dir(0.0, 0.0, 1.0))
    if abs(low_radius - high_radius) < _SAME:
        return BRepPrimAPI_MakeCylinder(axis, float(low_radius), float(high - low)).Shape()
    return BRepPrimAPI_MakeCone(
        axis, float(low_radius), float(high_radius), float(high - low)
    ).Shape()


def _stem(sphere: DatumSphere) -> Any:
    """Stem up to the ball's centre, and on downwards into the base by the same taper."""
    top = sphere.centre[2]
    taper = (sphere.foot_radius - sphere.stem_radius) / (top - sphere.foot)
    foot_radius = sphere.foot_radius + _ROOT * taper
    return _cone(
        sphere.centre[0],
        sphere.centre[1],
        sphere.foot - _ROOT,
        top,
        foot_radius,
        sphere.stem_radius,
    )


def _ball(sphere: DatumSphere) -> Any:
    axis = gp_Ax2(_point(sphere.centre), gp_Dir(0.0, 0.0, 1.0))
    return BRepPrimAPI_MakeSphere(axis, float(sphere.radius)).Shape()


def _hole(hole: MountingHole, base: Base) -> list[Any]:
    through = _cone(hole.x, hole.y, -1.0, base.thickness + 1.0, hole.radius, hole.radius)
    floor = base.thickness - hole.bore_depth
    bore = _cone(hole.x, hole.y, floor, base.thickness + 1.0, hole.bore_radius, hole.bore_radius)
    return [through, bore]


def _boolean(operation: Any, arguments: list[Any], tools: list[Any], what: str) -> Any:
    """Result of one boolean operation, refused unless it is done and valid."""
    first, second = List_TopoDS_Shape(), List_TopoDS_Shape()
    for shape in arguments:
        first.Append(shape)
    for shape in tools:
        second.Append(shape)
    operation.SetArguments(first)
    operation.SetTools(second)
    operation.Build()
    if not operation.IsDone() or not solids_of(operation.Shape()):
        raise NotBuildable(f"the CAD kernel failed at {what}")
    return operation.Shape()


def _only_solid(shape: Any, name: str) -> Any:
    solids = solids_of(shape)
    if len(solids) != 1:
        sizes = ", ".join(f"{volume(solid):.0f}" for solid in solids)
        raise NotBuildable(
            f"standard '{name}' falls into {len(solids)} solids of {sizes} mm^3; a column or a "
            "stem does not reach the body"
        )
    if not is_valid(solids[0]):
        raise NotBuildable(f"standard '{name}': the CAD kernel calls its own solid invalid")
    return without_pockets(solids[0])


def without_pockets(solid: Any) -> Any:
    """The solid with its closed pockets filled; one without any comes back as it is.

    Columns that lean together above the plate can enclose a small wedge of air, which no tool
    reaches and nobody could probe or clean.
    """
    if len(shells_of(solid)) == 1:
        return solid
    return BRepBuilderAPI_MakeSolid(BRepClass3d.OuterShell_s(solid)).Solid()


def _point(p: Array) -> Any:
    return gp_Pnt(float(p[0]), float(p[1]), float(p[2]))


def _direction(d: Array) -> Any:
    return gp_Dir(float(d[0]), float(d[1]), float(d[2]))
