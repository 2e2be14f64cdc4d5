"""The blank of a standard: base, fittings, material and limits."""

from dataclasses import dataclass, field

from matstd.artefact.body import Base, Limits, Material


@dataclass(frozen=True, slots=True)
class Fittings:
    """Spheres and holes of every standard.

    Attributes:
        sphere_radius: Of the precision balls, mm.
        highest_sphere: Height of the highest centre above the seat, mm; the tool passes over it.
        post_radius: Of a post at the centre of its ball, mm.
        hole_radius: Of the through hole, mm (M10: 5.5).
        bore_radius: Of the counterbore, mm (M10: 9).
        bore_depth: Mm (M10: 11).
    """

    sphere_radius: float = 12.5
    highest_sphere: float = 95.0
    post_radius: float = 8.0
    hole_radius: float = 5.5
    bore_radius: float = 9.0
    bore_depth: float = 11.0


@dataclass(frozen=True, slots=True)
class Blank:
    """All of a standard but its patches.

    Attributes:
        height: Of the blank above the seat, mm.
    """

    base: Base = field(default_factory=Base)
    fittings: Fittings = field(default_factory=Fittings)
    material: Material = field(default_factory=lambda: Material().with_usual_modulus())
    height: float = 220.0
    limits: Limits = field(default_factory=Limits)
