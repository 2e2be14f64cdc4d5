"""Lettering of dots, put into the plane faces of a solid.

A general cut with a thousand balls takes the kernel five seconds, most of them to find out which
of a thousand holes lies in which face. That is known here: a dot is one hole more in its plane
face and the cap of a ball below it, which share one circle.
"""

from collections.abc import Sequence
from typing import Any

import numpy as np
from OCP.BRep import BRep_Builder, BRep_Tool
from OCP.BRepAdaptor import BRepAdaptor_Surface
from OCP.BRepAlgoAPI import BRepAlgoAPI_Cut
from OCP.BRepBuilderAPI import (
    BRepBuilderAPI_MakeFace,
    BRepBuilderAPI_MakeSolid,
    BRepBuilderAPI_MakeWire,
)
from OCP.BRepPrimAPI import BRepPrimAPI_MakeSphere
from OCP.GeomAbs import GeomAbs_SurfaceType
from OCP.gp import gp_Ax2, gp_Dir, gp_Pnt2d
from OCP.IntTools import IntTools_FClass2d
from OCP.TopAbs import TopAbs_Orientation, TopAbs_State
from OCP.TopoDS import TopoDS, TopoDS_Shell

from matstd.cad_out.details import CUTTER, DEPTH, DOT, Lettering
from matstd.cad_out.kernel.faces import edges_of, faces_of
from matstd.cad_out.kernel.primitives import boolean, point
from matstd.twin.frames import Array, apply, turn

_ON = 1e-6  # mm: a line of text lies in a face
_RIM = 0.1  # mm between a dot and the edge of its face, at least


def engraved(solid: Any, lettering: Sequence[Lettering]) -> Any:
    """A solid with its lettering.

    Args:
        lettering: On plane faces; what reaches beyond the edge of one is cut as well, but slowly.
    """
    faces = faces_of(solid)
    holes: dict[int, list[Any]] = {}
    caps, tools = list[Any](), list[Any]()
    for line in lettering:
        middles = apply(line.T_artefact_text, np.pad(line.dots, ((0, 0), (0, 1))))
        on = next((i for i, face in enumerate(faces) if _carries(face, line, middles)), None)
        for middle in middles:
            if on is None:
                tools.append(_ball(line, middle))
            else:
                hole, cap = _dot(line, middle, faces[on].Orientation())
                holes.setdefault(on, []).append(hole)
                caps.append(cap)
    for i, wires in holes.items():
        faces[i] = _with_holes(faces[i], wires)
    body = _closed([*faces, *caps])
    return boolean(BRepAlgoAPI_Cut(), [body], tools, "engraving") if tools else body


def _carries(face: Any, line: Lettering, middles: Array) -> bool:
    if _kind(face) != GeomAbs_SurfaceType.GeomAbs_Plane:
        return False
    T, plane = line.T_artefact_text, BRepAdaptor_Surface(face).Plane().Position()
    frame = (plane.Location(), plane.XDirection(), plane.YDirection())
    origin, x, y = (np.array([v.X(), v.Y(), v.Z()]) for v in frame)
    normal = np.cross(x, y)
    if np.linalg.norm(np.cross(normal, T[:3, 2])) > _ON or abs((T[:3, 3] - origin) @ normal) > _ON:
        return False
    inside = IntTools_FClass2d(face, _ON)
    ring = turn(T, (DOT + _RIM) * np.array([[1, 0, 0], [0, 1, 0], [-1, 0, 0], [0, -1, 0]]))
    at = (middles[:, None] + ring).reshape(-1, 3) - origin
    places = zip(at @ x, at @ y, strict=True)
    return all(
        inside.Perform(gp_Pnt2d(float(u), float(v))) == TopAbs_State.TopAbs_IN for u, v in places
    )


def _ball(line: Lettering, middle: Array) -> Any:
    """What the cutter takes away: poles and seam lie outside the material."""
    T = line.T_artefact_text
    out, along = gp_Dir(*map(float, T[:3, 2])), gp_Dir(*map(float, T[:3, 0]))
    centre = point(middle + (CUTTER - DEPTH) * T[:3, 2])
    return BRepPrimAPI_MakeSphere(gp_Ax2(centre, along, out), CUTTER).Shape()


def _dot(line: Lettering, middle: Array, orientation: Any) -> tuple[Any, Any]:
    """Rim of a dot as a hole in a face of the given orientation, and the cap below it."""
    out = line.T_artefact_text[:3, 2]
    frame = gp_Ax2(point(middle + (CUTTER - DEPTH) * out), gp_Dir(*map(float, out)))
    rim_at = float(np.arcsin((DEPTH - CUTTER) / CUTTER))
    chip = BRepPrimAPI_MakeSphere(frame, CUTTER, -0.5 * np.pi, rim_at).Shape()
    cap = next(f for f in faces_of(chip) if _kind(f) == GeomAbs_SurfaceType.GeomAbs_Sphere)
    (rim,) = (edge for edge in edges_of(cap) if not BRep_Tool.IsClosed_s(edge, cap))  # no seam
    hole = BRepBuilderAPI_MakeWire(rim).Wire()
    is_forward = orientation == TopAbs_Orientation.TopAbs_FORWARD
    return hole if is_forward else TopoDS.Wire(hole.Reversed()), cap.Reversed()


def _kind(face: Any) -> Any:
    return BRepAdaptor_Surface(face).GetType()


def _with_holes(face: Any, wires: Sequence[Any]) -> Any:
    """The face with additional holes, of the same orientation."""
    forward = TopoDS.Face(face.Oriented(TopAbs_Orientation.TopAbs_FORWARD))
    maker = BRepBuilderAPI_MakeFace(forward)
    for wire in wires:
        maker.Add(wire)
    return maker.Face().Oriented(face.Orientation())


def _closed(faces: Sequence[Any]) -> Any:
    """A solid of faces that share their edges."""
    builder, shell = BRep_Builder(), TopoDS_Shell()
    builder.MakeShell(shell)
    for face in faces:
        builder.Add(shell, face)
    shell.Closed(BRep_Tool.IsClosed_s(shell))
    return BRepBuilderAPI_MakeSolid(shell).Solid()
