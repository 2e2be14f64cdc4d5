"""The only conversion factors in the house: a name without suffix is in mm, rad, s, degC or N."""

import math
from collections.abc import Sequence

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
WHOLE_DEGREES, DEGREES_ROUNDING = 5.0, 0.1
"""Ends of a travel are whole multiples of the first; in radians they are still such multiples
within the second, degrees, or within half of their last decimal."""
MIN_DECIMALS = 2
"""Decimals of an angle in radians: with one, 5.7 degrees apart, anything may be meant."""
USUAL_TOOL_LENGTH, TOOL_LENGTHS = 160.0, (40.0, 1000.0)
"""From the gauge point to the tip, mm: the usual length of a probe or a tool, and the shortest and
longest that are taken without a question."""
LENGTHS = (("cm", 10.0), ("inches", 25.4), ("metres", 1e3), ("µm", 1e-3), ("tenths of a mm", 0.1))
"""Units in which the length of a probe may have been typed instead of mm, and one of each in mm."""
OTHERS = {
    "mm": (("metres", 1e3), ("µm", 1e-3)),
    "µm": (("mm", 1e3), ("nm", 1e-3)),
    "µrad": (("mrad", 1e3), ("nrad", 1e-3)),
    "degrees": (("radians", 1.0 / DEG),),
    "mm/min": (("m/min", 1e3),),
    "kg": (("t", 1e3), ("g", 1e-3)),
    "MPa": (("GPa", 1e3), ("Pa", 1e-6)),
}
"""Units in which a number may have been typed instead of its own, and what one of them is."""
NEAR = 4.0
"""Times by which numbers differ at most from what is usual, in the unit in which they were typed.
As they stand they then differ by 14 times or more."""
WHOLE_MM, LEAST_MM, MOST_METRES = 5.0, 20.0, 1.0
"""A place in metres: all coordinates are whole multiples of the first in mm, the largest no smaller
than the second, and below the third. A place that was measured in mm is no such thing."""
WHOLE_TURN, LEAST_TURN, TURN_DECIMALS = 15.0, 30.0, 3
"""Rotations in radians: whole multiples of the first, degrees, none between zero and the second,
typed with so many decimals. Rotations that were measured are no such thing."""
FULL_TURN = 2.0 * math.pi + 0.01  # ends beyond are no angles in radians of one turn


def meant_in_radians(
    low: float, high: float, whole: float = WHOLE_DEGREES
) -> tuple[float, float] | None:
    """The whole degrees that two numbers are in radians; None where they are no such thing.

    Args:
        whole: Degrees that they are multiples of.

    Example:
        >>> meant_in_radians(-1.92, 0.61), meant_in_radians(-5.0, 5.0), meant_in_radians(-0.5, 0.7)
        ((-110.0, 35.0), None, None)
    """
    decimals = [len(f"{v:.6f}".rstrip("0").partition(".")[2]) for v in (low, high)]
    if max(decimals) < MIN_DECIMALS or max(-low, high) > FULL_TURN or not low < high:
        return None
    meant = [whole * round(v / DEG / whole) for v in (low, high)]
    for v, m, count in zip((low, high), meant, decimals, strict=True):
        # 0.26 beside -1.658 is rounded by itself
        if abs(v / DEG - m) > max(DEGREES_ROUNDING, 0.5 * 10.0 ** -max(count, MIN_DECIMALS) / DEG):
            return None
    return meant[0], meant[1]


def doubtful_length(length: float, known: Sequence[float] = (USUAL_TOOL_LENGTH,)) -> str | None:
    """What to ask about the length of a probe or a tool; None for one that is plausible.

    Args:
        length: From the gauge point to the tip, mm.
        known: Lengths of probes of the same machine: lengths near them are plausible, too.

    Example:
        >>> doubtful_length(16.0), doubtful_length(6.3), doubtful_length(100.0)
        ('is it in cm, 160 mm?', 'is it in inches, 160 mm?', None)
        >>> doubtful_length(30.0, known=(32.0,))
    """
    low, high = TOOL_LENGTHS
    if low <= length <= high or any(k / NEAR < length < k * NEAR for k in known):
        return None
    usual = min(known, default=USUAL_TOOL_LENGTH)
    meant = [(name, factor * length) for name, factor in LENGTHS if low <= factor * length <= high]
    if length <= 0.0 or not meant:
        return f"{low:g} to {high:g} mm from the gauge point to the tip"
    name, mm = min(meant, key=lambda one: abs(math.log(one[1] / usual)))
    return f"is it in {name}, {mm:.4g} mm?"


def in_another_unit(
    values: Sequence[float], unit: str, usual: float | None
) -> tuple[str, float] | None:
    """The unit in which numbers were probably typed, and what one of it is in their own.

    Args:
        values: One number, or several of one kind such as sides, a place, rotations.
        unit: Of the numbers, as `OTHERS` has it.
        usual: Size of the largest that is usual, in this unit; None where any is.

    Returns:
        None where the numbers fit their own unit.

    Example:
        >>> in_another_unit([0.785], "degrees", 45.0), in_another_unit([0.012], "mm", None)
        (('radians', 57.29577951308232), None)
        >>> in_another_unit([0.05, 0.02, 0.0], "mm", None)
        ('metres', 1000.0)
    """
    largest = max(map(abs, values))
    if usual is not None:
        near = (o for o in OTHERS.get(unit, ()) if 1.0 / NEAR < o[1] * largest / usual < NEAR)
        return next(near, None) if largest else None
    is_whole = {"mm": _are_metres, "degrees": _are_radians}.get(unit)
    return OTHERS[unit][0] if largest and is_whole and is_whole(values) else None


def _are_metres(values: Sequence[float]) -> bool:
    """Whether three coordinates are whole in mm if they are metres."""
    mm = [1e3 * v for v in values]
    is_whole = all(_is_multiple(v, WHOLE_MM, 1e-6) for v in mm)
    largest = max(map(abs, mm))
    return len(mm) == 3 and is_whole and LEAST_MM <= largest < 1e3 * MOST_METRES


def _are_radians(values: Sequence[float]) -> bool:
    """Whether angles are whole in degrees if they are radians."""
    turned = [v for v in values if v]
    decimals = min(len(f"{v:.6f}".rstrip("0").partition(".")[2]) for v in turned)
    allowed = 0.5 * 10.0**-decimals / DEG
    is_whole = all(_is_multiple(v / DEG, WHOLE_TURN, allowed) for v in turned)
    is_large = min(map(abs, turned)) / DEG > LEAST_TURN - allowed
    return decimals >= TURN_DECIMALS and is_whole and is_large


def _is_multiple(value: float, of: float, allowed: float) -> bool:
    return abs(value - of * round(value / of)) <= allowed
