"""STEP AP242 out and in, and the kernel's triangulation, through calls whose settings are ours."""

import re
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from OCP.APIHeaderSection import APIHeaderSection_MakeHeader
from OCP.BRep import BRep_Tool
from OCP.BRepMesh import BRepMesh_IncrementalMesh
from OCP.BRepTools import BRepTools
from OCP.collections import Sequence_TDF_Label
from OCP.IFSelect import IFSelect_ReturnStatus
from OCP.Interface import Interface_Static
from OCP.Quantity import Quantity_Color, Quantity_TypeOfColor
from OCP.STEPCAFControl import (
    STEPCAFControl_Controller,
    STEPCAFControl_Reader,
    STEPCAFControl_Writer,
)
from OCP.STEPControl import STEPControl_Controller
from OCP.TCollection import TCollection_ExtendedString, TCollection_HAsciiString
from OCP.TDataStd import TDataStd_Name
from OCP.TDocStd import TDocStd_Document
from OCP.TopAbs import TopAbs_Orientation
from OCP.TopLoc import TopLoc_Location
from OCP.XCAFApp import XCAFApp_Application
from OCP.XCAFDoc import XCAFDoc_ColorType, XCAFDoc_DocumentTool, XCAFDoc_ShapeTool, XCAFDoc_Volume
from OCP.XSControl import XSControl_WorkSession

from artefact.body import Standard
from cad_out.build.faces import faces_of, is_closed, is_valid, shells_of, solids_of, volume
from cad_out.build.solid import Solid
from twin.errors import NotBuildable
from twin.frames import Array
from twin.versions import versions

TIME_STAMP = "2000-01-01T00:00:00"
"""In every STEP file: the same standard gives the same bytes."""

_ANGLE = 0.3  # rad between neighbouring triangles; the chord decides on all but tiny radii

_COLOURS = {
    "FF": (0.13, 0.40, 0.75),
    "SPH": (0.80, 0.15, 0.12),
    "DATUM": (0.16, 0.60, 0.28),
}
_BODY = (0.66, 0.68, 0.70)
_SCHEMA_AP242 = 5


@dataclass(frozen=True, slots=True)
class Reread:
    """What the kernel finds in a STEP file that it has read anew."""

    solids: int
    is_valid: bool
    is_closed: bool
    shells: int
    volume: float
    names: tuple[str, ...]


@dataclass(frozen=True, slots=True)
class Origin:
    """Where a STEP file comes from, for its header.

    Attributes:
        design: SHA-256 of the design file, `standard.toml`.
        author: Who is responsible for it.
        organisation: Whom the author works for.
    """

    design: str
    author: str
    organisation: str


def write_step(path: Path, solid: Solid, standard: Standard, origin: Origin) -> None:
    """Write AP242 in millimetres: one part, named and coloured faces, material, volume.

    Args:
        path: The file; written in one go by the kernel, so give a neighbour name.
        solid: To be written.
        standard: For name and material.
        origin: For the header.

    Raises:
        NotBuildable: The kernel refuses to translate or to write.
    """
    document = _document()
    label = _filled(document, solid, standard)
    XCAFDoc_Volume.Set_s(label, solid.volume)
    _set_up_writer(standard.name)
    writer = STEPCAFControl_Writer(XSControl_WorkSession(), False)
    writer.SetColorMode(True)
    writer.SetNameMode(True)
    writer.SetPropsMode(True)
    writer.SetMaterialMode(True)
    if not writer.Transfer(document):
        raise NotBuildable(
            f"standard '{standard.name}': the CAD kernel cannot translate it to STEP"
        )
    _write_header(writer.ChangeWriter().Model(), standard, origin)
    if writer.Write(str(path)) != IFSelect_ReturnStatus.IFSelect_RetDone:
        raise NotBuildable(f"{path}: the CAD kernel cannot write the STEP file")
    path.write_text(with_unit_of_density(path.read_text(encoding="utf-8")), encoding="utf-8")


def with_unit_of_density(text: str) -> str:
    """A STEP text whose density is in g/cm^3, as its number is.

    The kernel writes the exponents 3 of the gram and 2 of the centimetre, whatever it is told.

    Raises:
        NotBuildable: The density is not written as it was when this was found.
    """
    item = re.search(r"'density',POSITIVE_RATIO_MEASURE\([^)]*\),#(\d+)\)", text)
    unit = item and re.search(rf"^#{item[1]} = DERIVED_UNIT\(\(#(\d+),#(\d+)\)\);", text, re.M)
    if not unit:
        raise NotBuildable("the CAD kernel wrote no density with a unit of mass and length")
    for number, written, meant in ((unit[1], "3.", "1."), (unit[2], "2.", "-3.")):
        element = rf"^(#{number} = DERIVED_UNIT_ELEMENT\(#\d+,){re.escape(written)}\);"
        text, count = re.subn(element, rf"\g<1>{meant});", text, flags=re.M)
        if count != 1:
            raise NotBuildable(f"the CAD kernel wrote another unit of density in entity #{number}")
    return text


def read_step(path: Path) -> Reread:
    """Read a STEP file with a fresh reader and look at what is in it."""
    STEPCAFControl_Controller.Init_s()
    STEPControl_Controller.Init_s()
    _setting("read.stepcaf.subshapes.name", 1)
    reader = STEPCAFControl_Reader()
    reader.SetNameMode(True)
    if reader.ReadFile(str(path)) != IFSelect_ReturnStatus.IFSelect_RetDone:
        raise NotBuildable(f"{path}: the CAD kernel cannot read its own STEP file")
    document = _document()
    reader.Transfer(document)
    tool = XCAFDoc_DocumentTool.ShapeTool_s(document.Main())
    labels = Sequence_TDF_Label()
    tool.GetFreeShapes(labels)
    shapes = [XCAFDoc_ShapeTool.GetShape_s(labels.Value(i)) for i in range(1, labels.Length() + 1)]
    solids = [solid for shape in shapes for solid in solids_of(shape)]
    names = [name for i in range(1, labels.Length() + 1) for name in _names(labels.Value(i))]
    return Reread(
        solids=len(solids),
        is_valid=all(is_valid(solid) for solid in solids),
        is_closed=all(is_closed(solid) for solid in solids),
        shells=sum(len(shells_of(solid)) for solid in solids),
        volume=sum(volume(solid) for solid in solids),
        names=tuple(sorted(names)),
    )


def tessellate(solid: Solid, chord: float) -> tuple[Array, np.ndarray, np.ndarray]:
    """Triangles of the solid as the kernel makes them, face by face and not yet joined.

    Args:
        solid: To be meshed; an older mesh on it is dropped.
        chord: Absolute deflection asked for, mm. It is a request and not a guarantee.

    Returns:
        Corners (V, 3), triangles (F, 3) with outward winding, and for each triangle the index
        of its face in the order of the solid's faces (F,).
    """
    BRepTools.Clean_s(solid.shape)
    # The third argument is "relative": it must be False, or the chord means something else.
    BRepMesh_IncrementalMesh(solid.shape, chord, False, _ANGLE, True)
    corners: list[Array] = []
    triangles: list[np.ndarray] = []
    owners: list[np.ndarray] = []
    count = 0
    for number, face in enumerate(faces_of(solid.shape)):
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


def face_numbers(solid: Solid) -> dict[str, int]:
    """Index of every named face in the order of the solid's faces."""
    order = faces_of(solid.shape)
    return {
        name: next(i for i, other in enumerate(order) if other.IsSame(face))
        for name, face in solid.faces.items()
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


def _document() -> Any:
    document = TDocStd_Document(TCollection_ExtendedString("XmlOcaf"))
    XCAFApp_Application.GetApplication_s().NewDocument(
        TCollection_ExtendedString("MDTV-XCAF"), document
    )
    XCAFDoc_DocumentTool.SetLengthUnit_s(document, 0.001)
    return document


def _filled(document: Any, solid: Solid, standard: Standard) -> Any:
    """Put the solid into the document with names, colours and material; label of the part."""
    XCAFDoc_ShapeTool.SetAutoNaming_s(False)
    shapes = XCAFDoc_DocumentTool.ShapeTool_s(document.Main())
    colours = XCAFDoc_DocumentTool.ColorTool_s(document.Main())
    materials = XCAFDoc_DocumentTool.MaterialTool_s(document.Main())
    label = shapes.AddShape(solid.shape, False)
    TDataStd_Name.Set_s(label, TCollection_ExtendedString(_part_name(standard)))
    colours.SetColor(label, _colour(_BODY), XCAFDoc_ColorType.XCAFDoc_ColorSurf)
    for name, face in solid.faces.items():
        sub = shapes.AddSubShape(label, face)
        TDataStd_Name.Set_s(sub, TCollection_ExtendedString(name))
        for start, colour in _COLOURS.items():
            if name.startswith(start):
                colours.SetColor(sub, _colour(colour), XCAFDoc_ColorType.XCAFDoc_ColorSurf)
    # The kernel wants g/cm^3, whatever the length unit of the document.
    materials.SetMaterial(
        label,
        _text(standard.material.name),
        _text(f"thermal expansion {standard.material.expansion:.6g} 1/K"),
        standard.material.density * 1e6,
        _text("density"),
        _text("POSITIVE_RATIO_MEASURE"),
    )
    return label


def _part_name(standard: Standard) -> str:
    return f"{standard.name} {standard.serial}".strip()


def _set_up_writer(product: str) -> None:
    # Settings made before the controllers exist are dropped without a word.
    STEPCAFControl_Controller.Init_s()
    STEPControl_Controller.Init_s()
    _setting("write.step.schema", _SCHEMA_AP242)
    _setting("write.stepcaf.subshapes.name", 1)
    _setting("write.surfacecurve.mode", 1)
    _setting("write.precision.mode", 0)
    if not Interface_Static.SetCVal_s("write.step.product.name", product):
        raise NotBuildable("the CAD kernel does not know its setting write.step.product.name")


def _setting(name: str, value: int) -> None:
    if not Interface_Static.SetIVal_s(name, value):
        raise NotBuildable(f"the CAD kernel does not know its setting {name}")


def _write_header(model: Any, standard: Standard, origin: Origin) -> None:
    header = APIHeaderSection_MakeHeader(model)
    header.SetName(_text(_part_name(standard)))
    header.SetTimeStamp(_text(TIME_STAMP))
    header.SetAuthorValue(1, _text(in_ascii(origin.author)))
    header.SetOrganizationValue(1, _text(in_ascii(origin.organisation)))
    header.SetOriginatingSystem(_text("material-standard"))
    tool = f"material-standard {versions()['material-standard']}"
    header.SetPreprocessorVersion(_text(tool))
    header.SetAuthorisation(_text("not stated"))
    words = f"Freeform material standard, SHA-256 of standard.toml {origin.design}"
    header.SetDescriptionValue(1, _text(words))
    header.Apply(model)


def in_ascii(text: str) -> str:
    """Text for a header: what is not ASCII as ISO 10303-21, 6.4.3.3 writes it, UTF-16 in hex."""
    return re.sub(
        r"[^ -~]+", lambda m: f"\\X2\\{m[0].encode('utf-16-be').hex().upper()}\\X0\\", text
    )


def _names(label: Any) -> list[str]:
    """Names of the sub-shapes of a part."""
    subs = Sequence_TDF_Label()
    XCAFDoc_ShapeTool.GetSubShapes_s(label, subs)
    found = []
    for i in range(1, subs.Length() + 1):
        name = TDataStd_Name()
        # Asking for an attribute that is not there crashes the process.
        if subs.Value(i).IsAttribute(TDataStd_Name.GetID_s()):
            subs.Value(i).FindAttribute(TDataStd_Name.GetID_s(), name)
            found.append(name.Get().ToExtString())
    return found


def _colour(rgb: tuple[float, float, float]) -> Any:
    return Quantity_Color(*rgb, Quantity_TypeOfColor.Quantity_TOC_sRGB)


def _text(value: str) -> Any:
    return TCollection_HAsciiString(value)
