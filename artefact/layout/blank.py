"""The blank of a standard: base, fittings, material and limits."""

from dataclasses import dataclass, field

from matstd.artefact.body import Base, Limits, Material


@dataclass(frozen=True, slots=True)
class Fittings:
    """Spheres and holes of every standard."""

    sphere_radius: float = 12.5  # of the precision balls, mm
    # height of the highest centre above the seat, mm; the tool passes over it
    highest_sphere: float = 95.0
    post_radius: float = 8.0  # of a post at the centre of its ball, mm
    hole_radius: float = 5.5  # of the through hole, mm (M10: 5.5)
    bore_radius: float = 9.0  # of the counterbore, mm (M10: 9)
    bore_depth: float = 11.0  # mm (M10: 11)


@dataclass(frozen=True, slots=True)
class Blank:
    """All of a standard but its patches."""

    base: Base = field(default_factory=Base)
    fittings: Fittings = field(default_factory=Fittings)
    material: Material = field(default_factory=lambda: Material().with_usual_modulus())
    height: float = 220.0  # of the blank above the seat, mm
    limits: Limits = field(default_factory=Limits)
