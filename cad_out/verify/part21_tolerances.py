"""Geometrical tolerances, sizes and notes of a STEP file, read from its text alone."""

import re

from cad_out.details import Tolerance

_KINDS = {
    "FLATNESS": "flatness",
    "PARALLELISM": "parallelism",
    "PERPENDICULARITY": "perpendicularity",
    "POSITION": "position",
    "SURFACE_PROFILE": "profile",
}
_KIND = re.compile(r"\b(" + "|".join(_KINDS) + r")_TOLERANCE\(")
_VALUE = re.compile(r"TOLERANCE\('[^']*','[^']*',#(\d+),#(\d+)")
_SYSTEM = re.compile(r"WITH_DATUM_REFERENCE\(\(#(\d+)\)\)")
_REFERENCE = re.compile(r"#(\d+)")


def read_tolerances(entities: dict[int, str]) -> list[Tolerance]:
    """Every geometrical tolerance with the face that it is on and its datums in order."""
    faces = {}
    for entity in entities.values():
        if entity.startswith("GEOMETRIC_ITEM_SPECIFIC_USAGE("):
            aspect, _, face = (int(r) for r in _REFERENCE.findall(entity))
            faces[aspect] = entities[face].split("'")[1]
    found = []
    for entity in entities.values():
        kind, value = _KIND.search(entity), _VALUE.search(entity)
        if kind is None or value is None:
            continue
        width = re.search(r"LENGTH_MEASURE\(([^)]*)\)", entities[int(value[1])])
        system = _SYSTEM.search(entity)
        letters = _letters(entities, int(system[1])) if system else ""
        assert width is not None
        name = faces.get(int(value[2]), "")
        found.append(Tolerance(name, _KINDS[kind[1]], float(width[1]), letters))
    return found


def _letters(entities: dict[int, str], system: int) -> str:
    """Datums of a system in the order of its compartments."""
    compartments = re.findall(r"\(((?:#\d+,?)+)\)\)$", entities[system])
    letters = ""
    for compartment in _REFERENCE.findall(compartments[0]):
        datum = _REFERENCE.findall(entities[int(compartment)])[1]
        letters += entities[int(datum)].split("'")[-2]
    return letters


def read_notes(entities: dict[int, str]) -> list[str]:
    """General notes in their order."""
    notes = {}
    for entity in entities.values():
        match = re.match(r"DESCRIPTIVE_REPRESENTATION_ITEM\('note (\d+)','(.*)'\)$", entity)
        if match is not None:
            notes[int(match[1])] = match[2]
    return [notes[number] for number in sorted(notes)]
