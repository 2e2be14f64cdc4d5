"""How well the features of a calibrated standard are known, and whether they conform."""

from collections.abc import Mapping
from dataclasses import dataclass


@dataclass(frozen=True, slots=True)
class KnownFeature:
    """Calibration of one feature; standard uncertainties.

    Attributes:
        points: That it rests upon.
        u: Of its place in every direction, which all touches on it share, mm.
        u_tilt: Of its rotations, rad; 0 of a ball.
        u_form: Of its surface at a point, beyond that, mm.
    """

    points: int
    u: float
    u_tilt: float
    u_form: float


GUARD = 1.65
"""Standard uncertainties between a measured value and a limit that prove on which side of it the
true value is, with 95 % (ISO 14253-1:2017)."""


@dataclass(frozen=True, slots=True)
class Verdict:
    """Whether a characteristic of a feature is within its tolerance, by ISO 14253-1.

    Attributes:
        feature: Name; of the scale those of the two balls that are farthest from each other.
        characteristic: `diameter`, `position`, `profile` or `scale`.
        deviation: From the design, mm.
        tolerance: Largest deviation that is allowed, mm.
        u: Standard uncertainty of the deviation, mm.
    """

    feature: str
    characteristic: str
    deviation: float
    tolerance: float
    u: float

    @property
    def is_refused(self) -> bool:
        """Whether it is proven to be out of tolerance."""
        return abs(self.deviation) - GUARD * self.u > self.tolerance

    @property
    def state(self) -> str:
        """What is proven of it."""
        if self.is_refused:
            return "not conforming"
        is_proven = abs(self.deviation) + GUARD * self.u <= self.tolerance
        return "conforming" if is_proven else "cannot be decided"


@dataclass(frozen=True)
class Known:
    """The calibration of a standard.

    Attributes:
        source: File of points that it was made from.
        nominal: Fingerprint of the standard as designed.
        features: By name; the others are as designed and as uncertain as they are assumed to be.
        verdicts: Whether they conform to the drawing; empty where that was not judged.
    """

    source: str
    nominal: str
    features: Mapping[str, KnownFeature]
    verdicts: tuple[Verdict, ...] = ()

    @property
    def accepted(self) -> tuple[str, ...]:
        """What was accepted although it does not conform, "SPH1 diameter"."""
        return tuple(f"{v.feature} {v.characteristic}" for v in self.verdicts if v.is_refused)
