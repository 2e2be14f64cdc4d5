"""What leaves the service: limited, never in a jump, and honest about its age."""

from dataclasses import dataclass
from enum import StrEnum

from matstd.compensation.service.point_correction import Point
from matstd.twin.errors import BadValue
from matstd.twin.units import UM

_MAX_STEP_TIME = 0.05  # s that one step may stand for: a pause is no licence to jump


class Quality(StrEnum):
    """What a correction is worth."""

    VALID = "valid"
    LIMITED = "limited"
    """More was wanted than may be added."""
    HELD = "held"
    """No reading came in time, or one that is not understood: the last correction stays."""
    FADING = "fading"
    """None came for longer: the correction goes to zero, slowly."""


@dataclass(frozen=True)
class OutputLimits:
    """What a control is asked to add at most.

    Raises:
        BadValue: A number that is not above zero, or a hold shorter than the patience.
    """

    most: float = 200.0 * UM  # largest correction of each axis, mm
    rate: float = 1.0  # its change, mm/s: 1 mm/s follows 0.5 µm/mm at 120 m/min, and 20 µm in 20 ms
    patience: float = 0.5  # age at which a correction is no longer valid, s
    hold: float = 5.0  # age at which it begins to go to zero, s

    def __post_init__(self) -> None:
        for name in ("most", "rate", "patience", "hold"):
            value = getattr(self, name)
            if not 0.0 < value < float("inf"):
                raise BadValue(name, f"{value:g}", "a number above zero")
        if self.hold < self.patience:
            expected = f"the patience, {self.patience:g} s, or more"
            raise BadValue("hold", f"{self.hold:g} s", expected)


@dataclass(frozen=True)
class Sent:
    """What is given to the control."""

    values: Point  # corrections of the three linear axes, mm
    quality: Quality
    age: float  # since the readings that they were made for, s; infinite before the first
    lag: float  # largest way that a value still has to go, mm


class Output:
    """Goes towards what is wanted, at a rate; begins at zero."""

    def __init__(self, limits: OutputLimits) -> None:
        """Nothing is added yet."""
        self.limits = limits
        self._values: Point = (0.0, 0.0, 0.0)
        self._wanted: Point = (0.0, 0.0, 0.0)
        self._asked: float | None = None
        self._now: float | None = None

    def want(self, wanted: Point, now: float) -> None:
        """A new correction, for readings of this moment."""
        self._wanted, self._asked = wanted, now

    def step(self, now: float) -> Sent:
        """What is given to the control at this moment."""
        passed = 0.0 if self._now is None else min(max(now - self._now, 0.0), _MAX_STEP_TIME)
        self._now = now
        age = float("inf") if self._asked is None else now - self._asked
        most, far = self.limits.most, self.limits.rate * passed
        aim = tuple(min(max(v, -most), most) for v in self._wanted)
        quality = Quality.VALID if aim == self._wanted else Quality.LIMITED
        if age > self.limits.hold:
            quality, aim = Quality.FADING, (0.0, 0.0, 0.0)
        elif age > self.limits.patience:
            quality = Quality.HELD
        x, y, z = (v + min(max(a - v, -far), far) for v, a in zip(self._values, aim, strict=True))
        self._values = (x, y, z)
        lag = max(abs(a - v) for v, a in zip(self._values, aim, strict=True))
        return Sent(self._values, quality, age, lag)
