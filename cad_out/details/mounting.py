"""What a standard stands on and is held by, and what is bought: balls and screws, ISO 4762."""

from collections.abc import Iterable
from dataclasses import dataclass

import numpy as np

from matstd.artefact.body import Material, MountingHole, Standard, outline_distance
from matstd.cad_out.details.places import Side

BALL = Material(name="100Cr6 (1.3505), hardened, ISO 3290-1 G5", density=7.83e-6, expansion=11.5e-6)
"""Of a bought ball."""

SCREW = Material(name="steel, property class 8.8", density=7.85e-6, expansion=11.5e-6)
"""Of a bought screw."""

RELIEF = 1.0  # how far the underside stands back from the pads, mm
RELIEF_RADIUS = 3.0  # of the inner edge between a pad and the relief, mm
_PAD_RIM = 4.0  # mm that a pad is wider than the counterbore above it
_BESIDE_PAD = 1.5  # mm of relief between a pad's flank and the outline, at least
_RADIUS_STEP = 0.05  # mm of radius: the diameter of a pad is in tenths
_IN_NUT = 1.5  # of its diameter that a screw reaches into the nut of the slot
_SCREWS = (  # ISO 4762 and ISO 273, medium: diameter, through hole, head, mm
    (4.0, 4.5, 7.0),
    (5.0, 5.5, 8.5),
    (6.0, 6.6, 10.0),
    (8.0, 9.0, 13.0),
    (10.0, 11.0, 16.0),
    (12.0, 13.5, 18.0),
    (16.0, 17.5, 24.0),
)
_LENGTHS = (16, 20, 25, 30, 35, 40, 45, 50, 55, 60, 65, 70, 80, 90, 100, 110, 120)


@dataclass(frozen=True, slots=True)
class Screw:
    """A cylinder-head screw."""

    diameter: float  # of its thread, mm; its head is as high
    head: float  # diameter of the head, mm
    length: float  # below the head, mm
    # name, x and y of the holes it is for, and height under its head, mm
    holes: tuple[tuple[str, float, float, float], ...]

    @property
    def name(self) -> str:
        """Designation."""
        return f"ISO 4762 M{self.diameter:g}x{self.length:g}"


@dataclass(frozen=True, slots=True)
class Pad:
    """A round pad on which the standard stands, with a screw hole through it."""

    name: str  # SEAT1 ...
    x: float  # of its middle, mm
    y: float  # of its middle, mm
    radius: float  # mm


def pads_of(standard: Standard, sides: Iterable[Side]) -> tuple[Pad, ...]:
    """Three pads round three screws, so that tightening them bends nothing; else none.

    With another number of holes the standard stands on its whole underside. Pads near the outline
    are narrower, so that the relief between flank and outline keeps a width.
    """
    if len(standard.holes) != 3:
        return ()
    out = []
    for i, hole in enumerate(standard.holes, 1):
        at = np.array([hole.x, hole.y])
        base = standard.base
        room = [-float(outline_distance(at[None], base.half_size, base.corner_radius)[0])]
        room += [side.offset - float(at @ side.normal) for side in sides]
        widest = min(room) - relief_profile(0.0)[0] - _BESIDE_PAD
        widest = np.floor(widest / _RADIUS_STEP) * _RADIUS_STEP
        out.append(Pad(f"SEAT{i}", hole.x, hole.y, min(hole.bore_radius + _PAD_RIM, float(widest))))
    return tuple(out)


def screws_of(standard: Standard) -> tuple[Screw, ...]:
    """The largest screws that pass the holes and whose heads disappear in the counterbores.

    They reach one and a half diameters into the nut of a slot.
    """
    found: dict[tuple[float, float, float], list[MountingHole]] = {}
    for hole in standard.holes:
        kind = _largest(hole)
        if kind is not None:
            clamped = standard.base.thickness - hole.bore_depth
            long = next((n for n in _LENGTHS if n >= clamped + _IN_NUT * kind[0]), None)
            if long is not None:
                found.setdefault((*kind, float(long)), []).append(hole)
    return tuple(
        Screw(
            diameter,
            head,
            length,
            tuple((h.name, h.x, h.y, standard.base.thickness - h.bore_depth) for h in holes),
        )
        for (diameter, head, length), holes in found.items()
    )


def _largest(hole: MountingHole) -> tuple[float, float] | None:
    fits = [
        (diameter, head)
        for diameter, through, head in _SCREWS
        if through <= 2.0 * hole.radius + 1e-9
        and head < 2.0 * hole.bore_radius
        and diameter <= hole.bore_depth
    ]
    return max(fits, default=None)


def relief_profile(radius: float) -> tuple[float, float]:
    """Radius of a pad's flank at the relief's floor, and height of its arc's centre, mm.

    The flank is an arc of `RELIEF_RADIUS` that ends tangent to the floor, so there is no sharp
    inner edge although the step is lower than the radius.
    """
    below = RELIEF - RELIEF_RADIUS
    return radius + float(np.sqrt(RELIEF_RADIUS**2 - below**2)), below
