"""The only conversion factors in the house: a name without suffix is in mm, rad, s, degC or N."""

import math

UM = 1e-3
"""One micrometre in mm."""
NM = 1e-6  # one nanometre in mm
URAD = 1e-6
"""One microradian in rad."""
DEG = math.pi / 180.0
"""One degree in rad."""
KG_M3 = 1e-9  # one kilogram per cubic metre in kg/mm^3
GPA = 1e3  # one gigapascal in N/mm^2
MINUTE = 60.0
"""One minute in s."""
HOUR, DAY = 3600.0, 86400.0  # in s
T_REF = 20.0  # reference temperature of geometrical specifications, degC (ISO 1)
WHOLE_DEGREES, ROUNDING = 5.0, 0.1
"""Ends of a travel are whole multiples of the first; in radians they are still such multiples
within the second, degrees, or within half of their last decimal."""
MIN_DECIMALS = 2
"""Decimals of an angle in radians: with one, 5.7 degrees apart, anything may be meant."""
FULL_TURN = 2.0 * math.pi + 0.01  # ends beyond are no angles in radians of one turn


def meant_in_radians(low: float, high: float) -> tuple[float, float] | None:
    """The whole degrees that two numbers are in radians; None where they are no such thing.

    Example:
        >>> meant_in_radians(-1.92, 0.61), meant_in_radians(-5.0, 5.0), meant_in_radians(-0.5, 0.7)
        ((-110.0, 35.0), None, None)
    """
    decimals = max(len(f"{v:.6f}".rstrip("0").partition(".")[2]) for v in (low, high))
    if decimals < MIN_DECIMALS or max(-low, high) > FULL_TURN or not low < high:
        return None
    allowed = max(ROUNDING, 0.5 * 10.0**-decimals / DEG)
    ends = (low / DEG, high / DEG)
    meant = tuple(WHOLE_DEGREES * round(end / WHOLE_DEGREES) for end in ends)
    is_whole = all(abs(e - m) <= allowed for e, m in zip(ends, meant, strict=True))
    return (meant[0], meant[1]) if is_whole else None
