"""The touch probe as a body: what meets the surface, and what must not."""

from dataclasses import dataclass

import numpy as np

from artefact.reach import ProbeShape
from twin.errors import DesignError
from twin.frames import Array

NOSE_HEIGHT = 150.0
"""How much of the spindle above the gauge line is kept clear, mm."""


@dataclass(frozen=True)
class Probe:
    """Probe with a ball stylus along the tool axis, mm.

    Attributes:
        radius: Of the ball.
        length: From the spindle gauge point to the ball centre.
        stylus_length: From the ball centre to the probe's body; half the length where not given.
        stylus_radius: Of the thickest part of the stylus; two thirds of the ball where not given.
        body_radius: Of the probe's body (optical probes have 20 to 32 mm).
        nose_radius: Of the spindle nose above the gauge line.
    """

    radius: float = 3.0
    length: float = 160.0
    stylus_length: float = 0.0
    stylus_radius: float = 0.0
    body_radius: float = 25.0
    nose_radius: float = 45.0

    def __post_init__(self) -> None:
        if not 0.0 < self.radius < self.length:
            raise DesignError(
                f"probe of radius {self.radius} mm and length {self.length} mm: "
                "expected 0 < radius < length"
            )
        if not self.stylus_length:
            object.__setattr__(self, "stylus_length", 0.5 * self.length)
        if not self.stylus_radius:
            object.__setattr__(self, "stylus_radius", self.radius * 2.0 / 3.0)

    @property
    def tool_length(self) -> float:
        """Length in the tool table, mm: to the ball's far pole, not to its centre."""
        return self.length + self.radius

    @property
    def shape(self) -> ProbeShape:
        """Stylus, body and spindle nose as cylinders upwards from the ball centre."""
        return ProbeShape(
            self.radius,
            (
                (self.stylus_length, self.stylus_radius),
                (self.length, self.body_radius),
                (self.length + NOSE_HEIGHT, self.nose_radius),
            ),
        )

    def outline(self, sides: int = 16) -> Array:
        """Points on the rims of body and spindle nose from the ball centre, tool frame, (M, 3).

        Together with the ball they bound the tool from below in any direction that a tilting head
        may give it.
        """
        angle = np.arange(sides) * (2.0 * np.pi / sides)
        ring = np.stack([np.cos(angle), np.sin(angle), np.zeros(sides)], axis=-1)
        body = self.body_radius * ring + [0.0, 0.0, self.stylus_length]
        nose = self.nose_radius * ring + [0.0, 0.0, self.length]
        return np.concatenate([body, nose])
