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


_FIRST = "MECHANICAL_DESIGN_GEOMETRIC_PRESENTATION_REPRESENTATION("
_ENTITY = re.compile(r"^#(\d+) = (.*?);$", re.S | re.M)
_REFERENCE = re.compile(r"#(\d+)")


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


def with_reproducible_order(whole: str) -> str:
    """A STEP text whose colours follow in the order of the parts.

    The kernel writes them in an order that depends on its memory. Everything from the first
    of them on is renumbered: roots are sorted by their content, and the entities that they refer to
    follow.
    """
    at = whole.find(_FIRST)
    if at < 0:
        return whole
    start, end = whole.rindex("\n#", 0, at) + 1, whole.index("\nENDSEC;", at)
    found = [(int(key), body) for key, body in _ENTITY.findall(whole[start : end + 1])]
    tail = dict(found)
    if list(tail) != list(range(found[0][0], found[0][0] + len(found))):
        raise NotBuildable("the CAD kernel did not number the end of its STEP file in order")
    children = {k: [int(r) for r in _REFERENCE.findall(body)] for k, body in tail.items()}
    referred = {child for some in children.values() for child in some}
    first = found[0][0]
    roots = [key for key in tail if key not in referred]
    roots.sort(key=lambda key: _own_words(tail[key], first))
    order: dict[int, int] = {}
    waiting = roots[::-1]
    while waiting:
        key = waiting.pop()
        if key in tail and key not in order:
            order[key] = first + len(order)
            waiting += children[key][::-1]

    def renumbered(match: re.Match[str]) -> str:
        return f"#{order.get(int(match[1]), int(match[1]))}"

    lines = [f"#{new} = {_REFERENCE.sub(renumbered, tail[old])};" for old, new in order.items()]
    return whole[:start] + "\n".join(lines) + whole[end:]


def _own_words(body: str, first: int) -> tuple[str, list[int]]:
    """Sort key of an entity: its kind, and its references to entities that keep their numbers."""
    kept = [int(r) for r in _REFERENCE.findall(body) if int(r) < first]
    return re.sub(r"\s+", "", body).split("(")[0], kept


def without_runout_zones(whole: str) -> str:
    """A STEP text without the zones of a run-out that the kernel adds to every position."""
    angle = r"#\d+ = RUNOUT_ZONE_ORIENTATION\(#(\d+)\);\n"
    for number in re.findall(angle, whole):
        whole = re.sub(
            rf"^#{number} = PLANE_ANGLE_MEASURE_WITH_UNIT\([^;]*;\n", "", whole, flags=re.M
        )
    return re.sub(
        r"^#\d+ = RUNOUT_ZONE_(?:DEFINITION|ORIENTATION)\([^;]*;\n", "", whole, flags=re.M
    )


def with_units_of_density(whole: str, count: int) -> str:
    """A STEP text whose densities are in g/cm^3, as their numbers are.

    The kernel always writes exponents 3 of the gram and 2 of the centimetre.

    Raises:
        NotBuildable: The densities are not written as they were when this was found.
    """
    items = set(re.findall(r"'density',POSITIVE_RATIO_MEASURE\([^)]*\),#(\d+)\)", whole))
    found = re.findall(r"'density',POSITIVE_RATIO_MEASURE\(", whole)
    units = dict(re.findall(r"^#(\d+) = DERIVED_UNIT\(\(([^)]*)\)\);", whole, re.M))
    if len(found) != count or not items <= set(units):
        raise NotBuildable(
            f"the CAD kernel wrote {len(found)} densities with a unit of mass and length, "
            f"expected {count}"
        )
    for item in sorted(items, key=int):
        elements = _REFERENCE.findall(units[item])
        for number, (written, meant) in zip(elements, (("3.", "1."), ("2.", "-3.")), strict=True):
            element = rf"^(#{number} = DERIVED_UNIT_ELEMENT\(#\d+,){re.escape(written)}\);"
            whole, changed = re.subn(element, rf"\g<1>{meant});", whole, flags=re.M)
            if changed != 1:
                raise NotBuildable(f"the CAD kernel wrote another unit of density in #{number}")
    return whole


def with_descriptions(whole: str, products: Sequence[Product]) -> str:
    """A STEP text whose products say what they are; the kernel leaves the field empty."""
    for product in products:
        name = re.escape(product.name)
        whole, changed = re.subn(
            rf"(PRODUCT\('{name}','{name}',)''", rf"\g<1>'{product.about}'", whole
        )
        if changed != 1:
            raise NotBuildable(f"the CAD kernel wrote {changed} products '{product.name}'")
    return whole
