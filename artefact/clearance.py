"""Room for the probe: how near its stylus and body come to the standard at each touch."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from artefact.patch import rows, unit
from twin.errors import ShapeMismatch
from twin.frames import Array

if TYPE_CHECKING:
    from artefact.standard import Standard

_GROWTH = 1.15  # ratio of neighbouring stations along the tool axis
_BLOCK = 200_000  # stations looked at together


@dataclass(frozen=True, slots=True)
class ProbeShape:
    """A touch probe as cylinders round the tool axis, from the ball centre upwards.

    Attributes:
        ball_radius: Of the stylus tip, mm.
        cylinders: (end, radius) of each, mm from the ball centre, in ascending order; the first
            begins at the ball.
    """

    ball_radius: float
    cylinders: tuple[tuple[float, float], ...]

    def __post_init__(self) -> None:
        ends = [end for end, _ in self.cylinders]
        if not ends or ends != sorted(ends) or ends[0] <= self.ball_radius:
            raise ShapeMismatch(
                f"probe cylinders end at {ends} mm; expected ascending ends beyond the ball radius"
                f" {self.ball_radius:g} mm"
            )

    @property
    def length(self) -> float:
        """From the ball centre to the end of the last cylinder, mm."""
        return self.cylinders[-1][0]

    def stations(self) -> tuple[Array, Array]:
        """Points along the tool axis whose balls cover all cylinders.

        Returns:
            Distance from the ball centre, and radius of a ball there that covers the cylinder
            half-way to both neighbours, each of shape (K,), mm.
        """
        places, covers = [], []
        low = 0.0
        for end, radius in self.cylinders:
            first = max(low, 0.7 * self.ball_radius)
            count = max(int(np.ceil(np.log(end / first) / np.log(_GROWTH))), 1)
            cuts = np.geomspace(first, end, count + 1)
            places.append(0.5 * (cuts[1:] + cuts[:-1]))
            covers.append(np.hypot(radius, 0.5 * np.diff(cuts)))
            low = end
        return np.concatenate(places), np.concatenate(covers)


@dataclass(frozen=True, eq=False)
class Clearance:
    """Room at N touches.

    Attributes:
        distance: Of the probe above its ball from the standard, (N,), mm; never too large,
            negative where they may collide.
        body: Name of the body that is nearest, (N,).
    """

    distance: Array
    body: np.ndarray


def clearance(standard: Standard, centre: Array, tool_axis: Array, probe: ProbeShape) -> Clearance:
    """How near the probe comes to the standard with its ball at each centre; from below.

    The cylinders are covered by balls whose spacing grows with the distance from the tip, and
    compared with the distance to every body, so the figure errs on the safe side. The ball
    itself is not looked at: it is meant to touch.

    Args:
        standard: In the artefact frame.
        centre: Ball centres, shape (N, 3), artefact frame, mm.
        tool_axis: From the tip to the spindle, artefact frame, shape (N, 3) or (3,).
        probe: Stylus, stem and body.

    Returns:
        Room and the nearest body.
    """
    centre = rows(centre)
    axis = unit(rows(tool_axis, len(centre)))
    place, cover = probe.stations()
    room = np.full(len(centre), np.inf)
    nearest = np.zeros(len(centre), dtype=int)
    names = np.array(list(standard.bodies))
    for some in np.array_split(np.arange(len(centre)), len(centre) * len(place) // _BLOCK + 1):
        points = centre[some, None] + place[:, None] * axis[some, None]  # (n, K, 3)
        flat = points.reshape(-1, 3)
        each = np.stack(
            [
                (body.distance(flat).reshape(points.shape[:2]) - cover).min(axis=1)
                for body in standard.bodies.values()
            ]
        )
        nearest[some] = each.argmin(axis=0)
        room[some] = each.min(axis=0)
    return Clearance(room, names[nearest])
