"""Surfaces of a STEP file read from its text alone: the witness that knows no CAD kernel."""

import re
from dataclasses import dataclass
from pathlib import Path
from typing import NamedTuple

import numpy as np

from matstd.cad_out.verify.part21_tolerances import REFERENCE
from matstd.twin.errors import BadFile
from matstd.twin.frames import Array

_ENTITY = re.compile(r"#(\d+)\s*=\s*(.*?);\s*(?=#\d+\s*=|ENDSEC)", re.S)
_FACE = re.compile(r"ADVANCED_FACE\('([^']*)',\(([^)]*)\),#(\d+),\.([TF])\.\)")
_SPLINE = "B_SPLINE_SURFACE_WITH_KNOTS("
_BREAK = re.compile(r"('(?:[^']|'')*')|\s*\n\s*")


@dataclass(frozen=True, eq=False)
class SplineFace:
    """A B-spline surface as it stands in the file: degrees, full knot vectors, poles (U, V, 3)."""

    degree: tuple[int, int]
    knots: tuple[Array, Array]
    poles: Array

    def points(self, uv: Array) -> Array:
        """Points at parameters (N, 2) by scipy, (N, 3), mm."""
        from scipy.interpolate import NdBSpline

        spline = NdBSpline(self.knots, self.poles, k=self.degree)
        return spline(uv)


@dataclass(frozen=True, eq=False)
class SphereFace:
    """A sphere as it stands in the file."""

    centre: Array
    radius: float


class Instance(NamedTuple):
    """One part of the assembly where it stands."""

    product: str
    about: str
    moved: tuple[float, float, float]  # from the part's own origin, mm


def read_entities(path: Path) -> dict[int, str]:
    """Entities of a STEP file by number, without breaks; raises BadFile without a data section."""
    text = path.read_text(encoding="utf-8")
    entities = {int(key): _in_one_line(value) for key, value in _ENTITY.findall(text)}
    if not entities:
        raise BadFile(path, "DATA", "no entities", "a STEP file")
    return entities


def _in_one_line(value: str) -> str:
    """An entity without line breaks; blanks within a text are kept."""
    if "\n" not in value:
        return value
    return _BREAK.sub(lambda match: (match[1] or "").replace("\n", ""), value)


def read_faces(
    path: Path, known: dict[int, str] | None = None
) -> dict[str, SplineFace | SphereFace | None]:
    """Named spline and sphere faces of a STEP file; None for a face on any other surface.

    Args:
        known: Its entities where they were read already.

    Raises:
        BadFile: No data section, a face that refers to nothing, or two faces of one name.
    """
    entities = read_entities(path) if known is None else known
    faces: dict[str, SplineFace | SphereFace | None] = {}
    for number, entity in entities.items():
        match = _FACE.match(entity)
        if match is None or not match[1]:
            continue
        if match[1] in faces:
            raise BadFile(path, f"#{number}", f"a second face '{match[1]}'", "names used once")
        surface = entities.get(int(match[3]))
        if surface is None:
            raise BadFile(path, f"#{number}", f"a reference to #{match[3]}", "an entity")
        faces[match[1]] = _surface(entities, surface)
    return faces


def read_instances(entities: dict[int, str]) -> dict[str, Instance]:
    """Product structure: every instance by its name, with its part and where that stands."""
    products = _of_kind(entities, "PRODUCT")
    formations = _of_kind(entities, "PRODUCT_DEFINITION_FORMATION")
    definitions = _of_kind(entities, "PRODUCT_DEFINITION")
    shapes = _of_kind(entities, "PRODUCT_DEFINITION_SHAPE")
    placed = {}
    for fields in _of_kind(entities, "CONTEXT_DEPENDENT_SHAPE_REPRESENTATION").values():
        usage = _number(shapes[_number(fields[1])][2])
        relation = entities[_number(fields[0])]
        transformation = re.search(r"WITH_TRANSFORMATION\(#(\d+)\)", relation)
        assert transformation is not None
        ends = REFERENCE.findall(entities[int(transformation[1])])
        origins = [REFERENCE.findall(entities[int(end)])[0] for end in ends]
        placed[usage] = np.subtract(*(_point(entities[int(o)]) for o in origins[::-1]))
    found = {}
    for number, fields in _of_kind(entities, "NEXT_ASSEMBLY_USAGE_OCCURRENCE").items():
        product = products[_number(formations[_number(definitions[_number(fields[4])][2])][2])]
        x, y, z = placed[number]
        moved = (float(x), float(y), float(z))
        found[fields[1].strip("'")] = Instance(product[1].strip("'"), product[2].strip("'"), moved)
    return found


def _of_kind(entities: dict[int, str], kind: str) -> dict[int, list[str]]:
    """Fields of all simple entities of a kind."""
    start = f"{kind}("
    return {k: _fields(e[len(start) : -1]) for k, e in entities.items() if e.startswith(start)}


def _number(reference: str) -> int:
    return int(reference.lstrip("#"))


def file_unit_is_millimetre(path: Path) -> bool:
    """Whether the length unit of the shape is the millimetre."""
    text = path.read_text(encoding="utf-8")
    units = dict(
        re.findall(r"#(\d+)\s*=\s*\(\s*LENGTH_UNIT\(\)\s*NAMED_UNIT\(\*\)\s*([^;]*)\);", text)
    )
    shape = re.search(r"ADVANCED_BREP_SHAPE_REPRESENTATION\('[^']*',\([^)]*\),#(\d+)\)", text)
    if shape is None:
        return False
    context = re.search(rf"#{shape[1]}\s*=(.*?);", text, re.S)
    assigned = (
        re.search(r"GLOBAL_UNIT_ASSIGNED_CONTEXT\(\(([^)]*)\)\)", context[1]) if context else None
    )
    lengths = (
        [units[key] for key in REFERENCE.findall(assigned[1]) if key in units] if assigned else []
    )
    return bool(lengths) and all("SI_UNIT(.MILLI.,.METRE.)" in unit for unit in lengths)


def _surface(entities: dict[int, str], text: str) -> SplineFace | SphereFace | None:
    if text.startswith(_SPLINE):
        return _spline(entities, text)
    if text.startswith("SPHERICAL_SURFACE("):
        _, axis, radius = text[len("SPHERICAL_SURFACE(") : -1].split(",")
        origin = REFERENCE.findall(entities[int(axis.lstrip("#"))])[0]
        return SphereFace(_point(entities[int(origin)]), float(radius))
    return None


def _spline(entities: dict[int, str], text: str) -> SplineFace:
    """Fields: name, ku, kv, ((poles)), form, 3 flags, multiplicities u, v, knots u, v, kind."""
    fields = _fields(text[len(_SPLINE) : -1])
    rows = [REFERENCE.findall(row) for row in fields[3].strip("()").split("),(")]
    poles = np.array([[_point(entities[int(key)]) for key in row] for row in rows])
    counts = [np.array(fields[k].strip("()").split(","), dtype=int) for k in (8, 9)]
    values = [np.array(fields[k].strip("()").split(","), dtype=float) for k in (10, 11)]
    knots = (np.repeat(values[0], counts[0]), np.repeat(values[1], counts[1]))
    return SplineFace((int(fields[1]), int(fields[2])), knots, poles)


def _fields(text: str) -> list[str]:
    """Split at the commas outside all parentheses and quotes."""
    fields, depth, begin, quoted = [], 0, 0, False
    for i, letter in enumerate(text):
        quoted ^= letter == "'"
        if quoted:
            continue
        depth += (letter == "(") - (letter == ")")
        if letter == "," and depth == 0:
            fields.append(text[begin:i])
            begin = i + 1
    return [*fields, text[begin:]]


def _point(entity: str) -> Array:
    """``CARTESIAN_POINT('',(x,y,z))``."""
    return np.array(entity[entity.rindex("(") + 1 :].rstrip(")").split(","), dtype=float)
