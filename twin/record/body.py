"""The size of a standard: its expansion and temperature, and the correction for its growth.

The CMM that calibrated it has one scale and one temperature, which all calibrated points share.

Calibrated points hold at 20 degC. At T they move by ``alpha (T - 20 degC) p``, p from the origin of
the standard; where it is really held is a displacement, which the set-up absorbs.
"""

from dataclasses import dataclass, replace

import numpy as np

from matstd.twin.errors import BadValue
from matstd.twin.frames import Array
from matstd.twin.record.run import Run
from matstd.twin.record.touches import Body
from matstd.twin.units import T_REF

BODY = "body"  # name of the sensor that sits on the standard: column `T_body_degC`
U_SHARE = 0.1
"""Relative standard uncertainty of an expansion stated without one. JCGM 100:2008, H.1.3.3: steel
within 2e-6 of 11.5e-6 1/K, rectangular, u = 1.2e-6."""
U_KNOWN = 0.3
"""Standard uncertainty of a temperature stated without one, K: a resistance thermometer of class B
is within 0.4 K (IEC 60751), rectangular 0.23, and it sits on the standard, not in it."""
U_UNKNOWN = 2.0
"""Standard uncertainty, about 20 degC, of a temperature that is not stated, K: rooms of machine
tools keep within 3 or 4 K of it, and a standard that comes from elsewhere takes hours."""
COLDEST, HOTTEST = 0.0, 50.0
"""Range of temperatures of a standard, degC; others are of another body, or in kelvin."""
KELVIN = 270.0  # higher temperatures are in kelvin
LARGEST_EXPANSION = 1e-3  # largest expansion, 1/K; rubber has 2e-4, steel 11.5e-6
LARGEST_U = 20.0  # largest standard uncertainty of a temperature, K
LARGEST_SCALE = 1000.0  # largest relative standard uncertainty of calibrated lengths, ppm
MAX_DISAGREEMENT = 2.0
"""Standard uncertainties by which two statements of one temperature may differ."""


@dataclass(frozen=True, slots=True)
class StatedBody:
    """Statements on a standard under their names in files; None where one is missing.

    Raises:
        BadValue: A number in another unit, or of something else.
    """

    expansion_1_K: float  # noqa: N815  (K is the kelvin)
    expansion_u_1_K: float | None = None  # noqa: N815
    body_degC: float | None = None  # noqa: N815
    body_u_K: float | None = None  # noqa: N815
    scale_u_ppm: float | None = None

    def __post_init__(self) -> None:
        expansion = f"0 to {LARGEST_EXPANSION:g} 1/K: of steel 11.5e-6"
        for key, largest, expected in (
            ("expansion_1_K", LARGEST_EXPANSION, expansion),
            ("expansion_u_1_K", LARGEST_EXPANSION, expansion),
            ("body_u_K", LARGEST_U, f"a standard uncertainty from 0 to {LARGEST_U:g} K"),
            (
                "scale_u_ppm",
                LARGEST_SCALE,
                f"the standard uncertainty of calibrated lengths, 0 to {LARGEST_SCALE:g} ppm",
            ),
        ):
            value = getattr(self, key)
            if value is not None and not 0.0 <= value <= largest:
                raise BadValue(key, f"{value:g}", expected)
        if self.body_degC is not None:
            _check_temperature("body_degC", self.body_degC)


def with_body(run: Run, stated: StatedBody) -> Run:
    """A run with deviations from its standard, calibrated at 20 degC, at the temperature of it.

    Only here the growth of a standard is subtracted; `raw_deviation` adds it back. Readings of the
    sensor `body` replace the one temperature that is stated.

    Raises:
        BadValue: An instrument without a standard, or temperatures that cannot be.
    """
    touches = run.touches
    if not touches.instrument.is_ball_on_standard:
        found = f"expansion of a standard in a run of a {touches.instrument.value}"
        raise BadValue("expansion_1_K", found, "it for a touch-probe alone")
    at, common = touches.temperature.get(BODY), stated.body_degC
    is_known = at is not None or common is not None
    u = stated.body_u_K
    if u is None:
        u = U_KNOWN if is_known else U_UNKNOWN
    if at is not None:
        _check_readings(at, common, u)
    else:
        at = np.full(len(touches), T_REF if common is None else common)
    # an uncertainty that is not stated is a usual one: with zero a scale would look certain
    alpha, u_alpha = stated.expansion_1_K, stated.expansion_u_1_K
    body = Body(
        alpha,
        U_SHARE * alpha if u_alpha is None else u_alpha,
        u_temperature=u,
        is_known=is_known,
        u_scale=1e-6 * (stated.scale_u_ppm or 0.0),
    )
    setups = tuple(replace(s, body=body) for s in touches.setups)
    warm = replace(touches, setups=setups, body_temperature=at)
    return replace(run, touches=warm, deviation=run.raw_deviation - warm.growth)


def _check_readings(at: Array, common: float | None, u: float) -> None:
    """Refuse a sensor that is not on the standard, or contradicts the stated temperature."""
    for value in (at.min(), at.max()):
        _check_temperature(f"T_{BODY}_degC", float(value))
    if common is not None and abs(common - float(at.mean())) > MAX_DISAGREEMENT * u:
        raise BadValue(
            "body_degC",
            f"{common:g}, where T_{BODY}_degC is {at.mean():.2f} on average",
            f"one of the two, or both within {MAX_DISAGREEMENT * u:g} K",
        )


def _check_temperature(key: str, value: float) -> None:
    if not COLDEST <= value <= HOTTEST:
        why = "in kelvin" if value > KELVIN else "of another body"
        raise BadValue(
            key,
            f"{value:g} ({why}?)",
            f"the temperature of the standard, {COLDEST:g} to {HOTTEST:g} degC",
        )
