"""Semantic product manufacturing information: datums, tolerances, sizes and notes of products."""

from collections.abc import Sequence
from functools import partial
from typing import Any

from OCP.BRep import BRep_Builder
from OCP.BRepBuilderAPI import BRepBuilderAPI_MakeEdge
from OCP.BRepGProp import BRepGProp
from OCP.collections import Array1_double, Array1_gp_Pnt, Array1_int, Sequence_TDF_Label
from OCP.Geom import Geom_BSplineCurve
from OCP.gp import gp_Ax2, gp_Dir, gp_Pnt
from OCP.GProp import GProp_GProps
from OCP.StepShape import StepShape_AdvancedBrepShapeRepresentation
from OCP.StepVisual import StepVisual_DraughtingModel
from OCP.TCollection import TCollection_ExtendedString
from OCP.TDataStd import TDataStd_NamedData
from OCP.TopoDS import TopoDS_Compound
from OCP.XCAFDimTolObjects import (
    XCAFDimTolObjects_DatumObject,
    XCAFDimTolObjects_DimensionObject,
    XCAFDimTolObjects_DimensionType,
    XCAFDimTolObjects_GeomToleranceObject,
    XCAFDimTolObjects_GeomToleranceType,
    XCAFDimTolObjects_GeomToleranceTypeValue,
)
from OCP.XCAFDoc import (
    XCAFDoc_Datum,
    XCAFDoc_Dimension,
    XCAFDoc_DimTolTool,
    XCAFDoc_DocumentTool,
    XCAFDoc_GeomTolerance,
)

from matstd.cad_out.details import CALIBRATED, DATUMS, Tolerance
from matstd.cad_out.kernel.xcaf import labels_of, name_of, text
from matstd.twin.frames import Array

_KINDS = {
    "flatness": "Flatness",
    "parallelism": "Parallelism",
    "perpendicularity": "Perpendicularity",
    "position": "Position",
    "profile": "ProfileOfSurface",
}


def add_tolerances(
    document: Any,
    faces: dict[str, Any],
    tolerances: Sequence[Tolerance],
    drawn: dict[str, list[Array]],
) -> None:
    """Put datums and geometrical tolerances on named faces, and draw them."""
    tool = XCAFDoc_DocumentTool.DimTolTool_s(document.Main())
    # a datum is drawn once, although every tolerance refers to an object of its own
    left = dict(drawn)
    for tolerance in tolerances:
        label = tool.AddGeomTolerance()
        tool.SetGeomTolerance(faces[tolerance.face], label)
        attribute = XCAFDoc_GeomTolerance.Set_s(label)
        about = XCAFDimTolObjects_GeomToleranceObject()
        name = f"{tolerance.face} {tolerance.kind}"
        about.SetSemanticName(text(name))
        _draw(about, name, left)
        kind = f"XCAFDimTolObjects_GeomToleranceType_{_KINDS[tolerance.kind]}"
        about.SetType(getattr(XCAFDimTolObjects_GeomToleranceType, kind))
        about.SetValue(tolerance.width)
        if tolerance.kind == "position":
            diameter = "XCAFDimTolObjects_GeomToleranceTypeValue_SphericalDiameter"
            about.SetTypeOfValue(getattr(XCAFDimTolObjects_GeomToleranceTypeValue, diameter))
        attribute.SetObject(about)
        for position, letter in enumerate(tolerance.datums, 1):
            about = _datum(letter, position)
            _draw(about, f"datum {letter}", left)
            _refer(tool, label, faces[DATUMS[letter]], about)


def _draw(about: Any, name: str, left: dict[str, list[Array]]) -> None:
    """Give an object its sign, at the first call only."""
    if name not in left:
        return
    strokes, builder, sign = left.pop(name), BRep_Builder(), TopoDS_Compound()
    builder.MakeCompound(sign)
    for stroke in strokes:
        builder.Add(sign, _polyline(stroke))
    corner = gp_Pnt(*map(float, strokes[0][0]))
    about.SetPresentation(sign, text(name))
    about.SetPlane(gp_Ax2(corner, gp_Dir(0.0, 0.0, 1.0), gp_Dir(1.0, 0.0, 0.0)))
    about.SetPointTextAttach(corner)


def _polyline(corners: Array) -> Any:
    """One edge through points (N, 3): the writer makes a polyline of a spline of degree 1."""
    poles, knots = Array1_gp_Pnt(1, len(corners)), Array1_double(1, len(corners))
    times = Array1_int(1, len(corners))
    for number, corner in enumerate(corners, 1):
        poles.SetValue(number, gp_Pnt(*map(float, corner)))
        knots.SetValue(number, float(number))
        times.SetValue(number, 2 if number in (1, len(corners)) else 1)
    return BRepBuilderAPI_MakeEdge(Geom_BSplineCurve(poles, knots, times, 1)).Edge()


def _datum(letter: str, position: int) -> Any:
    about = XCAFDimTolObjects_DatumObject()
    about.SetName(text(letter))
    about.SetSemanticName(text(f"datum {letter}"))
    about.SetPosition(position)
    return about


def _refer(tool: Any, tolerance: Any, face: Any, about: Any) -> None:
    """Add a datum to a tolerance; the kernel has one object for every reference."""
    label = tool.AddDatum()
    on = Sequence_TDF_Label()
    on.Append(face)
    tool.SetDatum(on, label)
    XCAFDoc_Datum.Set_s(label).SetObject(about)
    tool.SetDatumToGeomTol(label, tolerance)


def add_diameter(
    document: Any, face: Any, diameter: float, name: str, drawn: dict[str, list[Array]]
) -> None:
    """The size of a ball on its face, with its sign if that has a name."""
    tool = XCAFDoc_DocumentTool.DimTolTool_s(document.Main())
    label = tool.AddDimension()
    on = Sequence_TDF_Label()
    on.Append(face)
    tool.SetDimension(on, Sequence_TDF_Label(), label)
    attribute = XCAFDoc_Dimension.Set_s(label)
    about = XCAFDimTolObjects_DimensionObject()
    spherical = "XCAFDimTolObjects_DimensionType_Size_SphericalDiameter"
    about.SetType(getattr(XCAFDimTolObjects_DimensionType, spherical))
    about.SetValue(diameter)
    about.SetUpperTolValue(CALIBRATED["diameter"])
    about.SetLowerTolValue(-CALIBRATED["diameter"])
    _draw(about, name, dict(drawn))
    attribute.SetObject(about)


def add_notes(label: Any, notes: Sequence[str]) -> None:
    """General notes of a product, as its properties."""
    data = TDataStd_NamedData.Set_s(label)
    for number, note in enumerate(notes, 1):
        data.SetString(
            TCollection_ExtendedString(f"note {number}"), TCollection_ExtendedString(note)
        )


def read_tolerances(document: Any) -> list[Tolerance]:
    """Geometrical tolerances of a document that was read, by the names of their faces."""
    tool = XCAFDoc_DocumentTool.DimTolTool_s(document.Main())
    words = {
        getattr(XCAFDimTolObjects_GeomToleranceType, f"XCAFDimTolObjects_GeomToleranceType_{k}"): w
        for w, k in _KINDS.items()
    }
    found = []
    for label in labels_of(tool.GetGeomToleranceLabels):
        about = XCAFDoc_GeomTolerance.Set_s(label).GetObject()
        first, second = Sequence_TDF_Label(), Sequence_TDF_Label()
        XCAFDoc_DimTolTool.GetRefShapeLabel_s(label, first, second)
        datums = labels_of(partial(XCAFDoc_DimTolTool.GetDatumWithObjectOfTolerLabels_s, label))
        letters = [XCAFDoc_Datum.Set_s(datum).GetObject() for datum in datums]
        letters.sort(key=lambda datum: datum.GetPosition())
        found.append(
            Tolerance(
                name_of(first.Value(1)) if first.Length() else "",
                words.get(about.GetType(), "other"),
                float(about.GetValue()),
                "".join(str(datum.GetName().ToCString()) for datum in letters),
            )
        )
    return found


def read_signs(document: Any) -> dict[str, tuple[float, float, float, float]]:
    """Length and centre of mass (x, y, z) of every drawn sign of a document, mm, by name."""
    tool = XCAFDoc_DocumentTool.DimTolTool_s(document.Main())
    found = {}
    for listed, attribute in (
        (tool.GetGeomToleranceLabels, XCAFDoc_GeomTolerance),
        (tool.GetDatumLabels, XCAFDoc_Datum),
        (tool.GetDimensionLabels, XCAFDoc_Dimension),
    ):
        for label in labels_of(listed):
            about = attribute.Set_s(label).GetObject()
            if about.GetPresentation() is not None:
                lines = GProp_GProps()
                BRepGProp.LinearProperties_s(about.GetPresentation(), lines)
                at = lines.CentreOfMass()
                name = str(about.GetPresentationName().ToCString())
                found[name] = (float(lines.Mass()), at.X(), at.Y(), at.Z())
    return found


def notes_of_label(label: Any) -> tuple[str, ...]:
    """General notes of a product that was read."""
    if not label.IsAttribute(TDataStd_NamedData.GetID_s()):
        return ()
    data = TDataStd_NamedData()
    label.FindAttribute(TDataStd_NamedData.GetID_s(), data)
    found: list[str] = []
    while data.HasString(TCollection_ExtendedString(f"note {len(found) + 1}")):
        key = TCollection_ExtendedString(f"note {len(found) + 1}")
        found.append(str(data.GetString(key).ToExtString()))
    return tuple(found)


def set_drawing_context(model: Any) -> None:
    """Give the drawn signs of a translated model their context.

    The kernel leaves it empty for an assembly, which makes the file invalid.
    """
    bodies, drawings = [], []
    for number in range(1, model.NbEntities() + 1):
        entity = model.Value(number)
        if isinstance(entity, StepShape_AdvancedBrepShapeRepresentation):
            bodies.append(entity)
        elif isinstance(entity, StepVisual_DraughtingModel):
            drawings.append(entity)
    for drawing in drawings:
        drawing.SetContextOfItems(bodies[0].ContextOfItems())
