"""Shapes of the kernel from plain numbers, and boolean operations that are refused if they fail."""

from collections.abc import Sequence
from typing import Any

import numpy as np
from OCP.BRepBuilderAPI import (
    BRepBuilderAPI_MakeEdge,
    BRepBuilderAPI_MakeFace,
    BRepBuilderAPI_MakeWire,
)
from OCP.BRepPrimAPI import (
    BRepPrimAPI_MakeBox,
    BRepPrimAPI_MakeCone,
    BRepPrimAPI_MakeCylinder,
    BRepPrimAPI_MakePrism,
    BRepPrimAPI_MakeRevol,
)
from OCP.collections import List_TopoDS_Shape
from OCP.GC import GC_MakeArcOfCircle
from OCP.gp import gp_Ax1, gp_Ax2, gp_Circ, gp_Dir, gp_Pnt, gp_Vec

from matstd.artefact.body import Base
from matstd.cad_out.details import Bore
from matstd.cad_out.kernel.faces import solids_of
from matstd.twin.errors import NotBuildable
from matstd.twin.frames import Array

_SAME = 1e-7  # mm: two points or radii are one


def cone(x: float, y: float, low: float, high: float, low_radius: float, high_radius: float) -> Any:
    """Upright cone frustum, or cylinder where both radii are one."""
    axis = gp_Ax2(gp_Pnt(float(x), float(y), float(low)), gp_Dir(0.0, 0.0, 1.0))
    if abs(low_radius - high_radius) < _SAME:
        return BRepPrimAPI_MakeCylinder(axis, float(low_radius), float(high - low)).Shape()
    return BRepPrimAPI_MakeCone(
        axis, float(low_radius), float(high_radius), float(high - low)
    ).Shape()


def box(low: Sequence[float], high: Sequence[float]) -> Any:
    """Box parallel to the axes between two corners."""
    return BRepPrimAPI_MakeBox(gp_Pnt(*map(float, low)), gp_Pnt(*map(float, high))).Shape()


def bore_solid(bore: Bore) -> Any:
    """What a blind hole takes away, with a millimetre before its mouth."""
    begin = np.array(bore.mouth) - np.array(bore.direction)
    axis = gp_Ax2(point(begin), gp_Dir(*bore.direction))
    return BRepPrimAPI_MakeCylinder(axis, bore.radius, bore.depth + 1.0).Shape()


def plate(base: Base) -> Any:
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


def revolved(x: float, y: float, profile: Sequence[tuple[float, ...]]) -> Any:
    """A solid of revolution about the upright line at x, y.

    Args:
        x: Of the axis, mm.
        y: Of the axis, mm.
        profile: Corners (radius, height) in order, beginning and ending on the axis, mm. A corner
            (radius, height, r, z) is reached along an arc through (r, z).
    """
    wire = BRepBuilderAPI_MakeWire()
    at = [gp_Pnt(x + corner[0], float(y), float(corner[1])) for corner in profile]
    for k in range(len(profile)):
        begin, end, corner = at[k - 1], at[k], profile[k]
        if len(corner) == 4:
            through = gp_Pnt(x + corner[2], float(y), float(corner[3]))
            arc = GC_MakeArcOfCircle(begin, through, end).Value()
            wire.Add(BRepBuilderAPI_MakeEdge(arc).Edge())
        else:
            wire.Add(BRepBuilderAPI_MakeEdge(begin, end).Edge())
    face = BRepBuilderAPI_MakeFace(wire.Wire()).Face()
    axis = gp_Ax1(gp_Pnt(float(x), float(y), 0.0), gp_Dir(0.0, 0.0, 1.0))
    return BRepPrimAPI_MakeRevol(face, axis).Shape()


def boolean(operation: Any, arguments: Sequence[Any], tools: Sequence[Any], what: str) -> Any:
    """Result of one boolean operation, refused unless it is done and leaves a solid."""
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


def point(p: Array) -> Any:
    """Of the kernel."""
    return gp_Pnt(float(p[0]), float(p[1]), float(p[2]))


def direction(d: Array) -> Any:
    """Of the kernel."""
    return gp_Dir(float(d[0]), float(d[1]), float(d[2]))
