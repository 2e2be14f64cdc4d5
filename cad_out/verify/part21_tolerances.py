"""Geometrical tolerances, notes and drawn signs of a STEP file, read from its text alone."""

import re
from typing import Any

import numpy as np

from matstd.artefact.body import Standard
from matstd.cad_out.details import Details, Tolerance, annotations_of, notes_of, tolerances_of
from matstd.twin.frames import Array
from matstd.twin.units import NM

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
REFERENCE = re.compile(r"#(\d+)")


def read_tolerances(entities: dict[int, str]) -> list[Tolerance]:
    """Every geometrical tolerance with the face that it is on and its datums in order."""
    faces = {}
    for entity in entities.values():
        if entity.startswith("GEOMETRIC_ITEM_SPECIFIC_USAGE("):
            aspect, _, face = (int(r) for r in REFERENCE.findall(entity))
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
    for compartment in REFERENCE.findall(compartments[0]):
        datum = REFERENCE.findall(entities[int(compartment)])[1]
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


def read_signs(entities: dict[int, str]) -> dict[str, list[Array]]:
    """What is drawn for tolerances, datums and sizes: polylines (N, 3), mm, by name.

    Only signs that belong to a statement and to a drawing with a context are found.
    """
    drawings = set()
    for key, entity in entities.items():
        if entity.startswith("DRAUGHTING_MODEL(") and entity.split("),")[-1].startswith("#"):
            drawings.add(key)
    found = {}
    for entity in entities.values():
        if not entity.startswith("DRAUGHTING_MODEL_ITEM_ASSOCIATION("):
            continue
        said, drawing, callout = (int(r) for r in REFERENCE.findall(entity))
        # a sign without its statement or its drawing does not count
        if said not in entities or drawing not in drawings:
            continue
        name = entities[callout].split("'")[1]
        at = callout
        while not entities[at].startswith("TESSELLATED_CURVE_SET("):
            at = int(REFERENCE.findall(entities[at])[-1])
        points, curves = entities[at].split(",", 2)[1:]
        listed = entities[int(points.lstrip("#"))].split(",", 2)[2]
        numbers = np.array(re.findall(r"-?\d+\.\d*(?:E[+-]?\d+)?", listed), dtype=float)
        corners = numbers.reshape(-1, 3)
        found[name] = [
            corners[np.array(curve.split(","), dtype=int) - 1]
            for curve in re.findall(r"\(([\d,]+)\)", curves)
        ]
    return found


def missing_annotations(
    standard: Standard, details: Details, entities: dict[int, str], found: dict[str, Any]
) -> tuple[str, ...]:
    """Tolerances, notes and signs that the text's reader or the kernel's does not find."""
    of_kernel = {Tolerance(*values) for values in found["tolerances"]}
    both = of_kernel & set(read_tolerances(entities))
    wanted = tolerances_of(standard, details)
    lost = [f"{t.kind} of {t.face}" for t in wanted if t not in both]
    notes = set(found["notes"]) & set(read_notes(entities))
    lost += [
        f"note {n}" for n, note in enumerate(notes_of(standard, details), 1) if note not in notes
    ]
    return (*lost, *_undrawn(annotations_of(standard, details), entities, found["signs"]))


def _undrawn(
    drawn: dict[str, list[Array]], entities: dict[int, str], of_kernel: dict[str, list[float]]
) -> list[str]:
    """Signs that the reader of the text or of the kernel does not find as designed."""
    of_text, lost = read_signs(entities), []
    for name, strokes in drawn.items():
        step = np.concatenate([np.diff(line, axis=0) for line in strokes])
        middle = np.concatenate([0.5 * (line[1:] + line[:-1]) for line in strokes])
        length = np.linalg.norm(step, axis=1)
        whole = [length.sum(), *(length @ middle / length.sum())]
        same = len(of_text.get(name, [])) == len(strokes) and all(
            one.shape == other.shape and np.abs(one - other).max() <= NM
            for one, other in zip(of_text[name], strokes, strict=True)
        )
        if not (same and np.allclose(of_kernel.get(name, np.inf), whole, rtol=0.0, atol=NM)):
            lost.append(f"sign of {name}")
    return lost
