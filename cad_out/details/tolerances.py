"""How exactly the body is made: what drawing and product manufacturing information state alike.

Faces and balls are calibrated after they are made, so a face may be off its nominal place by what
its calibration can hold and a touch does not feel; what the calibration stands on, the datums and
the pads, is fine.
"""

from typing import NamedTuple

from matstd.artefact.body import Standard
from matstd.cad_out.details.detail_list import Details

DATUMS = {"A": "DATUM_A", "B": "DATUM_B", "C": "DATUM_C"}
"""Faces that are the datums, in their order."""

GENERAL = 0.4  # width of the general profile tolerance of ISO 22081, mm: a milled body without fits

PROFILE, POSITION = 0.05, 0.2
FLATNESS, PARALLELISM, SQUARENESS = 0.005, 0.01, 0.02  # widths of tolerance zones, mm

FACE_ROUGHNESS = 0.4
"""Ra of freeform faces, um: a probing ball rests on peaks of four times that, which scatter from
touch to touch by less than a probe repeats."""

BALL_SIZE = 0.0025
"""Either way of the nominal diameter of a bought ball, mm; its lot is sorted far finer."""

BALL_FORM = 0.00013  # deviation from spherical form of a ball of grade 5, mm (ISO 3290-1)

CALIBRATED = {
    "diameter": BALL_SIZE,
    "form": BALL_FORM,
    "position": 0.5 * POSITION,
    "profile": 0.5 * PROFILE,
}
"""Largest deviations of balls and faces, which are calibrated, from what is drawn, mm."""


def widths() -> dict[str, float]:
    """Widths of tolerance zones by kind, and either side of the diameter of a ball, mm."""
    return {
        "flatness": FLATNESS,
        "parallelism": PARALLELISM,
        "perpendicularity": SQUARENESS,
        "profile": PROFILE,
        "position": POSITION,
        "diameter": BALL_SIZE,
    }


class Tolerance(NamedTuple):
    """One geometrical tolerance of ISO 1101."""

    face: str
    kind: str  # flatness, parallelism, perpendicularity, position or profile
    width: float  # of the zone, mm; a diameter for a position
    datums: str  # their letters in order; may be empty


def tolerances_of(standard: Standard, details: Details) -> tuple[Tolerance, ...]:
    """All tolerances of a body: datums first, then pads, faces and seats of balls."""
    pads = [pad.name for pad in details.pads] or ["SEAT"]
    return (
        Tolerance("DATUM_A", "flatness", FLATNESS, ""),
        Tolerance("DATUM_B", "perpendicularity", SQUARENESS, "A"),
        Tolerance("DATUM_C", "perpendicularity", SQUARENESS, "AB"),
        *(Tolerance(name, "parallelism", PARALLELISM, "A") for name in pads),
        *(Tolerance(patch.name, "profile", PROFILE, "ABC") for patch in standard.patches),
        # a cone has no centre that a spherical zone could hold; its profile places the ball
        *(Tolerance(f"{s.name}_SEAT", "profile", POSITION, "ABC") for s in standard.spheres),
    )


def _hardness(standard: Standard) -> str:
    stated = standard.material.hardness
    return f"; hardness {stated}" if stated and stated != "not specified" else ""


def notes_of(standard: Standard, details: Details) -> tuple[str, ...]:
    """General notes, in ASCII."""
    glue = (
        "Balls: lap the countersink with a ball to a bright band, degrease seat and ball, press in "
        "until metal meets metal, "
    )
    faces = (
        "Freeform faces: B-splines of this model are the nominal; as milled, "
        f"Ra {FACE_ROUGHNESS:g} um or finer, then calibrated."
    )
    notes = [
        f"Dimensions in mm, at 20 degC. General tolerances ISO 22081: sizes +-{GENERAL / 2:g}, "
        f"profile of a surface {GENERAL:g} | A | B | C; feet R 3, other edges ISO 13715; Ra 3.2 um "
        "where nothing else is stated.",
        "Datum A: upper face; B: side at -y, targets B1 and B2; C: side at -x, target C1.",
        *([faces] if standard.patches else []),
        glue + "glue outside the circle of contact only. Two-component epoxy of low shrinkage "
        "(1 % or less), gap as in the section, open at its rim so that air escapes; cure 24 h at "
        "room temperature under a weight of 10 N, calibrate a week later.",
        f"Material: {standard.material.name}{_hardness(standard)}. Rough with 1 mm of stock, "
        "stress-relieve, finish; no heat, straightening or blasting after that. No coating: "
        "degrease and oil.",
    ]
    if details.pads:
        notes.append("Stands on three pads round its screws; tighten evenly, no shims between.")
    return tuple(notes)
