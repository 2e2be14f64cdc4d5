"""Seats of bought balls on their posts.

A ball lies in a countersink of a standard angle and touches it along one circle, metal to metal.
The circle, and not the glue, fixes its centre in all three directions. The glue fills the wedge
outside the circle and only holds. With a spherical seat of the ball's own radius the place of
contact would be undefined; with a stud, a thread would fix the centre and a 5 mm screw the
stiffness.
"""

from dataclasses import dataclass

import numpy as np

from matstd.artefact.body import DatumSphere
from matstd.twin.errors import NotBuildable
from matstd.twin.units import DEG

HALF_ANGLES = (45.0 * DEG, 60.0 * DEG, 70.0 * DEG)
"""Of countersinks that are sold (90, 120 and 140 degrees); the steepest centres best."""

_GLUE_WIDTH_SHARE = 0.12  # of the ball's radius, from the circle of contact to the rim of the post
_LAND_WIDTH_SHARE = 0.04  # of the ball's radius, width of the ring on top of the post


@dataclass(frozen=True, slots=True)
class Seat:
    """Countersink on top of a post, in heights above the standard's seat, mm."""

    ball: str
    half_angle: float  # between the axis and the countersink, rad
    contact_radius: float  # of the circle along which the ball touches
    contact: float
    top: float
    top_radius: float  # of the post there
    rim_radius: float  # of the countersink there
    bottom: float  # height of the countersink's tip


def seat_of(sphere: DatumSphere) -> Seat:
    """The steepest countersink that leaves room for glue on the post of a ball.

    The post ends where cone and countersink meet in a narrow land, below the ball's surface,
    and stays within the cone that runs up to the ball's centre.

    Raises:
        NotBuildable: The post is too thin for any countersink.
    """
    R, centre = sphere.radius, float(sphere.centre[2])
    rim = R * np.cos(sphere.rim)
    half = next((a for a in HALF_ANGLES if R * np.cos(a) <= rim - _GLUE_WIDTH_SHARE * R), None)
    if half is None:
        raise NotBuildable(
            f"{sphere.name}: a post of {sphere.stem_radius:g} mm radius is too thin for the seat "
            f"of a ball of {R:g} mm"
        )
    circle, height = R * np.cos(half), centre - R * np.sin(half)
    taper = (sphere.foot_radius - sphere.stem_radius) / (centre - sphere.foot)
    land, rise = _LAND_WIDTH_SHARE * R, 1.0 / np.tan(half)
    # the outer cone less the land, and the countersink, at one height
    widest = sphere.stem_radius + taper * centre - land
    top = (height + rise * (widest - circle)) / (1.0 + rise * taper)
    outer = sphere.stem_radius + taper * (centre - top)
    return Seat(
        ball=sphere.name,
        half_angle=float(half),
        contact_radius=float(circle),
        contact=float(height),
        top=float(top),
        top_radius=float(outer),
        rim_radius=float(outer - land),
        bottom=float(height - rise * circle),
    )


def glue_gap(sphere: DatumSphere, seat: Seat) -> float:
    """Height of the wedge for the glue where it is widest, at the land, mm."""
    below = np.sqrt(sphere.radius**2 - seat.rim_radius**2)
    return float(sphere.centre[2] - below - seat.top)
