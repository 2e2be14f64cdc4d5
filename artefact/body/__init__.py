"""Shapes and bodies of a standard, its limits and its file."""

from artefact.body.datum import DatumSphere, MountingHole
from artefact.body.freeform import OVERHANG, ErrorShare, FreeformPatch, graph_patch
from artefact.body.limits import (
    Constraint,
    Limits,
    check,
    constraints,
    max_slope,
    min_concave_radius,
    overhang,
)
from artefact.body.patch import Mask, Meeting, Surface, rows, sphere_entry, unit
from artefact.body.solids import Plate, entry
from artefact.body.spline import Jet
from artefact.body.standard import STEEL, Base, Core, Material, Standard
from artefact.body.standard_file import read_standard, write_standard

__all__ = [
    "OVERHANG",
    "STEEL",
    "Base",
    "Constraint",
    "Core",
    "DatumSphere",
    "ErrorShare",
    "FreeformPatch",
    "Jet",
    "Limits",
    "Mask",
    "Material",
    "Meeting",
    "MountingHole",
    "Plate",
    "Standard",
    "Surface",
    "check",
    "constraints",
    "entry",
    "graph_patch",
    "max_slope",
    "min_concave_radius",
    "overhang",
    "read_standard",
    "rows",
    "sphere_entry",
    "unit",
    "write_standard",
]
