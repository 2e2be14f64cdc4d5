"""Semantic product manufacturing information: datums, tolerances, sizes and notes of products."""

from collections.abc import Sequence
from typing import Any

from OCP.collections import Sequence_TDF_Label
from OCP.TCollection import TCollection_ExtendedString
from OCP.TDataStd import TDataStd_NamedData
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

from cad_out.build.xcaf import name_of, text
from cad_out.details import BALL_SIZE, DATUMS, Tolerance

_KINDS = {
    "flatness": "Flatness",
    "parallelism": "Parallelism",
    "perpendicularity": "Perpendicularity",
    "position": "Position",
    "profile": "ProfileOfSurface",
}


def add_tolerances(document: Any, faces: dict[str, Any], tolerances: Sequence[Tolerance]) -> None:
    """Put datums and geometrical tolerances on named faces.

    Args:
        document: With the part.
        faces: Labels of the faces by their names.
        tolerances: Of the part.
    """
    tool = XCAFDoc_DocumentTool.DimTolTool_s(document.Main())
    for tolerance in tolerances:
        label = tool.AddGeomTolerance()
        tool.SetGeomTolerance(faces[tolerance.face], label)
        attribute = XCAFDoc_GeomTolerance.Set_s(label)
        about = XCAFDimTolObjects_GeomToleranceObject()
        about.SetSemanticName(text(f"{tolerance.face} {tolerance.kind}"))
        kind = f"XCAFDimTolObjects_GeomToleranceType_{_KINDS[tolerance.kind]}"
        about.SetType(getattr(XCAFDimTolObjects_GeomToleranceType, kind))
        about.SetValue(tolerance.width)
        if tolerance.kind == "position":
            diameter = "XCAFDimTolObjects_GeomToleranceTypeValue_SphericalDiameter"
            about.SetTypeOfValue(getattr(XCAFDimTolObjects_GeomToleranceTypeValue, diameter))
        attribute.SetObject(about)
        for position, letter in enumerate(tolerance.datums, 1):
            _refer(tool, label, faces[DATUMS[letter]], letter, position)


def _refer(tool: Any, tolerance: Any, face: Any, letter: str, position: int) -> None:
    """A datum of a tolerance, as the kernel has them: one object for every reference."""
    label = tool.AddDatum()
    on = Sequence_TDF_Label()
    on.Append(face)
    tool.SetDatum(on, label)
    attribute = XCAFDoc_Datum.Set_s(label)
    about = XCAFDimTolObjects_DatumObject()
    about.SetName(text(letter))
    about.SetSemanticName(text(f"datum {letter}"))
    about.SetPosition(position)
    attribute.SetObject(about)
    tool.SetDatumToGeomTol(label, tolerance)


def add_diameter(document: Any, face: Any, diameter: float) -> None:
    """The size of a ball on its face."""
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
    about.SetUpperTolValue(BALL_SIZE)
    about.SetLowerTolValue(-BALL_SIZE)
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
    labels, found = Sequence_TDF_Label(), list[Tolerance]()
    tool.GetGeomToleranceLabels(labels)
    for i in range(1, labels.Length() + 1):
        label = labels.Value(i)
        about = XCAFDoc_GeomTolerance.Set_s(label).GetObject()
        first, second = Sequence_TDF_Label(), Sequence_TDF_Label()
        XCAFDoc_DimTolTool.GetRefShapeLabel_s(label, first, second)
        datums = Sequence_TDF_Label()
        XCAFDoc_DimTolTool.GetDatumWithObjectOfTolerLabels_s(label, datums)
        letters = [
            XCAFDoc_Datum.Set_s(datums.Value(k)).GetObject() for k in range(1, datums.Length() + 1)
        ]
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
