"""STEP AP242 out, through calls whose settings are ours."""

import re
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from OCP.APIHeaderSection import APIHeaderSection_MakeHeader
from OCP.gp import gp_Trsf, gp_Vec
from OCP.IFSelect import IFSelect_ReturnStatus
from OCP.Interface import Interface_Static
from OCP.Quantity import Quantity_Color, Quantity_TypeOfColor
from OCP.STEPCAFControl import STEPCAFControl_Writer
from OCP.TopLoc import TopLoc_Location
from OCP.XCAFDoc import XCAFDoc_ColorType, XCAFDoc_DocumentTool, XCAFDoc_ShapeTool, XCAFDoc_Volume
from OCP.XSControl import XSControl_WorkSession

from matstd.cad_out.kernel.assembly import Product, colour_of
from matstd.cad_out.kernel.pmi import add_diameter, add_notes, add_tolerances, set_drawing_context
from matstd.cad_out.kernel.settled import (
    with_descriptions,
    with_reproducible_order,
    with_units_of_density,
    without_runout_zones,
)
from matstd.cad_out.kernel.xcaf import new_document, set_name, settings, text
from matstd.twin.errors import NotBuildable
from matstd.twin.versions import versions

TIME_STAMP = "2000-01-01T00:00:00"  # in every STEP file: the same standard gives the same bytes

_WHITE, _BLACK = (f"DRAUGHTING_PRE_DEFINED_COLOUR('{c}')" for c in ("white", "black"))
"""Ink of the kernel, unseen on paper, and ours."""

_SETTINGS = {
    "write.step.schema": 5,  # AP242
    "write.stepcaf.subshapes.name": 1,
    "write.surfacecurve.mode": 1,
    "write.precision.mode": 0,
}


@dataclass(frozen=True, slots=True)
class Origin:
    """Where a STEP file comes from, for its header."""

    design: str  # SHA-256 of the design file, `standard.toml`
    author: str  # who is responsible for it
    organisation: str  # the author's employer


def write_step(path: Path, products: Sequence[Product], name: str, origin: Origin) -> None:
    """Write AP242 in millimetres: an assembly, named and coloured faces, materials, volumes.

    Args:
        path: The file; written in one go by the kernel, so give a neighbour name.

    Raises:
        NotBuildable: The kernel refuses to translate or to write.
    """
    XCAFDoc_ShapeTool.SetAutoNaming_s(False)
    document = new_document()
    _fill(document, products, name)
    settings(_SETTINGS)
    if not Interface_Static.SetCVal_s("write.step.product.name", name):
        raise NotBuildable("the CAD kernel does not know its setting write.step.product.name")
    writer = STEPCAFControl_Writer(XSControl_WorkSession(), False)
    writer.SetColorMode(True)
    writer.SetNameMode(True)
    writer.SetPropsMode(True)
    writer.SetMaterialMode(True)
    writer.SetDimTolMode(True)
    writer.SetMetadataMode(True)
    if not writer.Transfer(document):
        raise NotBuildable(f"'{name}': the CAD kernel cannot translate it to STEP")
    set_drawing_context(writer.ChangeWriter().Model())
    _write_header(writer.ChangeWriter().Model(), name, origin)
    if writer.Write(str(path)) != IFSelect_ReturnStatus.IFSelect_RetDone:
        raise NotBuildable(f"{path}: the CAD kernel cannot write the STEP file")
    whole = path.read_text(encoding="utf-8").replace(_WHITE, _BLACK)
    whole = with_descriptions(whole, products)
    materials = {p.material for p in products} - {None}  # the kernel writes each once
    whole = with_units_of_density(without_runout_zones(whole), len(materials))
    path.write_text(with_reproducible_order(whole), encoding="utf-8")


def _fill(document: Any, products: Sequence[Product], name: str) -> None:
    """Put the products into the document, with names, colours and materials."""
    shapes = XCAFDoc_DocumentTool.ShapeTool_s(document.Main())
    whole = shapes.NewShape()
    set_name(whole, name)
    for product in products:
        label = _part(document, shapes, product)
        for instance, place in product.places:
            move = gp_Trsf()
            move.SetTranslation(gp_Vec(*place))
            component = shapes.AddComponent(whole, label, TopLoc_Location(move))
            set_name(component, instance)
    shapes.UpdateAssemblies()


def _part(document: Any, shapes: Any, product: Product) -> Any:
    colours = XCAFDoc_DocumentTool.ColorTool_s(document.Main())
    materials = XCAFDoc_DocumentTool.MaterialTool_s(document.Main())
    surface = XCAFDoc_ColorType.XCAFDoc_ColorSurf
    label = shapes.AddShape(product.shape, False)
    set_name(label, product.name)
    faces = {}
    colours.SetColor(label, _colour(product.colour), surface)
    for name, face in product.faces.items():
        sub = faces[name] = shapes.AddSubShape(label, face)
        set_name(sub, name)
        role = colour_of(name)
        if role is not None:
            colours.SetColor(sub, _colour(role), surface)
    material = product.material
    if material is not None:
        # The kernel wants g/cm^3, whatever the length unit of the document.
        materials.SetMaterial(
            label,
            text(material.name),
            text(f"thermal expansion {material.expansion:.6g} 1/K"),
            material.density * 1e6,
            text("density"),
            text("POSITIVE_RATIO_MEASURE"),
        )
        XCAFDoc_Volume.Set_s(label, product.volume)
    add_tolerances(document, faces, product.tolerances, product.drawn)
    if product.diameter is not None:
        sign = f"{product.name} diameter"
        add_diameter(document, faces[product.name], product.diameter, sign, product.drawn)
    if product.notes:
        add_notes(label, product.notes)
    return label


def _write_header(model: Any, name: str, origin: Origin) -> None:
    header = APIHeaderSection_MakeHeader(model)
    header.SetName(text(name))
    header.SetTimeStamp(text(TIME_STAMP))
    header.SetAuthorValue(1, text(in_ascii(origin.author)))
    header.SetOrganizationValue(1, text(in_ascii(origin.organisation)))
    header.SetOriginatingSystem(text("material-standard"))
    tool = f"material-standard {versions()['material-standard']}"
    header.SetPreprocessorVersion(text(tool))
    header.SetAuthorisation(text("not stated"))
    words = f"Freeform material standard, SHA-256 of standard.toml {origin.design}"
    header.SetDescriptionValue(1, text(words))
    header.Apply(model)


def in_ascii(words: str) -> str:
    """Text for a header: what is not ASCII as ISO 10303-21, 6.4.3.3 writes it, UTF-16 in hex."""
    return re.sub(
        r"[^ -~]+", lambda m: f"\\X2\\{m[0].encode('utf-16-be').hex().upper()}\\X0\\", words
    )


def _colour(rgb: tuple[float, float, float]) -> Any:
    return Quantity_Color(*rgb, Quantity_TypeOfColor.Quantity_TOC_sRGB)
