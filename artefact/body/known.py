"""How well the features of a standard are known: what stands in the file of a calibrated one."""

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


@dataclass(frozen=True)
class Known:
    """The calibration of a standard.

    Attributes:
        source: File of points that it was made from.
        nominal: Fingerprint of the standard as designed.
        features: By name; the others are as designed and as uncertain as they are assumed to be.
    """

    source: str
    nominal: str
    features: Mapping[str, KnownFeature]
