"""Calibration uncertainties of the features of a standard, and their conformity."""

from collections.abc import Mapping
from dataclasses import dataclass


@dataclass(frozen=True, slots=True)
class KnownFeature:
    """Calibration of one feature; standard uncertainties."""

    points: int
    u: float  # of its place in every direction, which all touches on it share, mm
    u_tilt: float  # of its rotations, rad; 0 of a ball
    u_form: float  # of its surface at a point, beyond that, mm
    # of its place along x, y and z where they differ, mm: a ball is measured on its upper half. `u`
    # is their root mean square then
    u_axes: tuple[float, float, float] | None = None

    @property
    def along(self) -> tuple[float, float, float]:
        """Standard uncertainties of its place along x, y and z, mm."""
        return (self.u, self.u, self.u) if self.u_axes is None else self.u_axes


GUARD_FACTOR = 1.65
"""Guard band in standard uncertainties; decides with 95 % on which side of a limit the true value
lies (ISO 14253-1:2017)."""


@dataclass(frozen=True, slots=True)
class Verdict:
    """Whether a characteristic of a feature is within its tolerance, by ISO 14253-1."""

    feature: str  # name; for the scale the names of the two balls with the largest distance
    characteristic: str  # `diameter`, `form`, `position`, `profile` or `scale`
    deviation: float  # measured minus designed, mm
    tolerance: float  # largest allowed deviation, mm
    u: float  # standard uncertainty of the deviation, mm

    @property
    def is_refused(self) -> bool:
        """Whether nonconformity is proven."""
        return abs(self.deviation) - GUARD_FACTOR * self.u > self.tolerance

    @property
    def state(self) -> str:
        """Conforming, not conforming, or neither proven."""
        if self.is_refused:
            return "not conforming"
        is_proven = abs(self.deviation) + GUARD_FACTOR * self.u <= self.tolerance
        return "conforming" if is_proven else "cannot be decided"


@dataclass(frozen=True)
class Known:
    """The calibration of a standard."""

    source: str
    nominal: str  # fingerprint of the standard as designed
    # by name; for other features the designed shape and assumed uncertainties hold
    features: Mapping[str, KnownFeature]
    # conformity with the drawing; empty where it was not evaluated
    verdicts: tuple[Verdict, ...] = ()
    # relative standard uncertainty of all its lengths at 20 degC, shared: scales and temperature of
    # the CMM; None where an earlier calibration does not state it
    u_scale: float | None = None

    @property
    def accepted(self) -> tuple[str, ...]:
        """Nonconforming characteristics that were accepted, such as "SPH1 diameter"."""
        return tuple(f"{v.feature} {v.characteristic}" for v in self.verdicts if v.is_refused)
