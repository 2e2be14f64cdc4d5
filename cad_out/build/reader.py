"""STEP files read anew by the kernel, and its triangulation."""

from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from OCP.BRep import BRep_Tool
from OCP.BRepMesh import BRepMesh_IncrementalMesh
from OCP.BRepTools import BRepTools
from OCP.collections import Sequence_TDF_Label
from OCP.IFSelect import IFSelect_ReturnStatus
from OCP.STEPCAFControl import STEPCAFControl_Reader
from OCP.TDF import TDF_Label
from OCP.TopAbs import TopAbs_Orientation
from OCP.TopLoc import TopLoc_Location
from OCP.XCAFDoc import XCAFDoc_DocumentTool, XCAFDoc_ShapeTool

from cad_out.build.faces import faces_of, is_closed, is_valid, shells_of, solids_of, volume
from cad_out.build.pmi import notes_of_label, read_tolerances
from cad_out.build.xcaf import name_of, new_document, settings
from cad_out.details import Tolerance
from twin.errors import NotBuildable
from twin.frames import Array

_ANGLE = 0.3  # rad between neighbouring triangles; the chord decides on all but tiny radii


@dataclass(frozen=True, slots=True)
class Reread:
    """What the kernel finds in a STEP file that it has read anew.

    Attributes:
        solids: All of them, instances counted.
        is_valid: No fault in any.
        is_closed: All shells are.
        shells: Of all solids.
        volume: Of all solids, mm^3.
        products: How often each product is there, by name.
        names: Of faces.
        tolerances: Geometrical tolerances with their datums.
        notes: General notes of all parts.
    """

    solids: int
    is_valid: bool
    is_closed: bool
    shells: int
    volume: float
    products: dict[str, int]
    names: tuple[str, ...]
    tolerances: tuple[Tolerance, ...]
    notes: tuple[str, ...]


def read_step(path: Path) -> Reread:
    """Read a STEP file with a fresh reader and look at what is in it."""
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
    free = Sequence_TDF_Label()
    tool.GetFreeShapes(free)
    wholes = [free.Value(i) for i in range(1, free.Length() + 1)]
    solids = [s for whole in wholes for s in solids_of(XCAFDoc_ShapeTool.GetShape_s(whole))]
    counted: dict[str, int] = {}
    names: set[str] = set()
    notes: list[str] = []
    for whole in wholes:
        for part in _parts(whole):
            counted[name_of(part)] = counted.get(name_of(part), 0) + 1
            names |= _face_names(part)
            notes += notes_of_label(part)
    return Reread(
        solids=len(solids),
        is_valid=all(is_valid(solid) for solid in solids),
        is_closed=all(is_closed(solid) for solid in solids),
        shells=sum(len(shells_of(solid)) for solid in solids),
        volume=sum(volume(solid) for solid in solids),
        products=counted,
        names=tuple(sorted(names)),
        tolerances=tuple(read_tolerances(document)),
        notes=tuple(notes),
    )


def _parts(whole: Any) -> list[Any]:
    """Labels of the parts of an assembly, one for each instance."""
    if not XCAFDoc_ShapeTool.IsAssembly_s(whole):
        return [whole]
    components = Sequence_TDF_Label()
    XCAFDoc_ShapeTool.GetComponents_s(whole, components, False)
    found = []
    for i in range(1, components.Length() + 1):
        part = TDF_Label()
        XCAFDoc_ShapeTool.GetReferredShape_s(components.Value(i), part)
        found += _parts(part)
    return found


def _face_names(part: Any) -> set[str]:
    subs = Sequence_TDF_Label()
    XCAFDoc_ShapeTool.GetSubShapes_s(part, subs)
    return {name_of(subs.Value(i)) for i in range(1, subs.Length() + 1)} - {""}


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
