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

PROFILE, POSITION = 0.05, 0.2
FLATNESS, PARALLELISM, SQUARENESS = 0.005, 0.01, 0.02
"""Widths of tolerance zones, mm."""

FACE_ROUGHNESS = 0.4
"""Ra of freeform faces, um: a probing ball rests on peaks of four times that, which scatter from
touch to touch by less than a probe repeats."""

BALL_SIZE = 0.0025
"""Either way of the nominal diameter of a bought ball, mm; its lot is sorted far finer."""

CALIBRATED = {"diameter": BALL_SIZE, "position": 0.5 * POSITION, "profile": 0.5 * PROFILE}
"""Largest deviations of balls and faces, which are calibrated, from what is drawn, mm."""


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
        *(Tolerance(f"{s.name}_SEAT", "position", POSITION, "ABC") for s in standard.spheres),
    )


def notes_of(standard: Standard, details: Details) -> tuple[str, ...]:
    """General notes, in ASCII."""
    glue = "Balls: degrease seat and ball, press into the countersink until metal meets metal, "
    notes = [
        "Dimensions in mm, at 20 degC. General tolerances ISO 2768-mK; inner edges R 3, outer "
        "edges broken by 0.2; Ra 3.2 um where nothing else is stated.",
        "Datum A: upper face; B: side at -y, two touches; C: side at -x, one touch.",
        "Freeform faces: B-splines of this model are the nominal; as milled, "
        f"Ra {FACE_ROUGHNESS:g} um or finer, then calibrated.",
        glue + "glue outside the circle of contact only.",
        f"Material: {standard.material.name}; stress-relieve before finishing.",
    ]
    if details.pads:
        notes.append("Stands on three pads round its screws; tighten evenly, no shims between.")
    return tuple(notes)
