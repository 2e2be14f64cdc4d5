"""The touch probe as a body: what meets the surface, and what must not."""

from dataclasses import dataclass, replace

import numpy as np

from matstd.artefact.reach import ProbeShape
from matstd.twin.errors import DesignError
from matstd.twin.frames import Array

NOSE_HEIGHT = 150.0  # how much of the spindle above the gauge line is kept clear, mm
_BODY_RADIUS = 25.0  # mm; of optical probes 20 to 32


@dataclass(frozen=True)
class Probe:
    """Probe with a ball stylus along the tool axis, mm."""

    radius: float = 3.0
    length: float = 160.0  # from the spindle gauge point to the ball centre
    # (end, radius) of its cylinders from the ball centre up to the gauge point: stylus, stem, body,
    # holder. Where not given, a stylus of two thirds of the ball and half the length, and a body of
    # 50 mm
    stack: tuple[tuple[float, float], ...] = ()
    nose_radius: float = 45.0  # of the spindle nose above the gauge line

    def __post_init__(self) -> None:
        if not 0.0 < self.radius < self.length:
            raise DesignError(
                f"probe of radius {self.radius} mm and length {self.length} mm: "
                "expected 0 < radius < length"
            )
        if not self.stack:
            stylus = (0.5 * self.length, self.radius * 2.0 / 3.0)
            object.__setattr__(self, "stack", (stylus, (self.length, _BODY_RADIUS)))
        if abs(self.stack[-1][0] - self.length) > 1e-6 or min(r for _, r in self.stack) <= 0.0:
            raise DesignError(
                f"cylinders of a probe {self.stack}: expected positive radii, and the last to end "
                f"at the gauge point, {self.length:g} mm from the ball centre"
            )

    def at_length(self, length: float) -> "Probe":
        """The same probe, held longer or shorter."""
        below = [(end, radius) for end, radius in self.stack[:-1] if end < length]
        return replace(self, length=length, stack=(*below, (length, self.stack[-1][1])))

    @property
    def tool_length(self) -> float:
        """Length in the tool table, mm: to the ball's far pole, not to its centre."""
        return self.length + self.radius

    @property
    def shape(self) -> ProbeShape:
        """The stack and the spindle nose as cylinders upwards from the ball centre."""
        nose = (self.length + NOSE_HEIGHT, self.nose_radius)
        return ProbeShape(self.radius, (*self.stack, nose))

    def outline(self, sides: int = 16) -> Array:
        """Points round the front rims of all but the stylus from the ball centre, tool frame.

        Together with the ball they bound the tool from below in any direction that a tilting head
        may give it: the rims are polygons from outside.

        Returns:
            Shape (M, 3), mm.
        """
        angle = np.arange(sides) * (2.0 * np.pi / sides)
        ring = np.stack([np.cos(angle), np.sin(angle), np.zeros(sides)], axis=-1)
        lows = [end for end, _ in self.stack]
        radii = [*(r for _, r in self.stack[1:]), self.nose_radius]
        return np.concatenate(
            [
                radius / np.cos(np.pi / sides) * ring + [0.0, 0.0, low]
                for low, radius in zip(lows, radii, strict=True)
            ]
        )
