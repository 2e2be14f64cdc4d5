"""The only conversion factors in the house: a name without suffix is in mm, rad, s, degC or N."""

import math

UM = 1e-3
"""One micrometre in mm."""

NM = 1e-6
"""One nanometre in mm."""

URAD = 1e-6
"""One microradian in rad."""

DEG = math.pi / 180.0
"""One degree in rad."""

KG_M3 = 1e-9
"""One kilogram per cubic metre in kg/mm^3."""

MINUTE, HOUR, DAY = 60.0, 3600.0, 86400.0
"""In s."""

T_REF = 20.0
"""Reference temperature of geometrical specifications, degC (ISO 1)."""

_SHOWN = {"mm": ("µm", UM), "rad": ("µrad", URAD)}


def shown(unit: str) -> tuple[str, float]:
    """Unit in which a report shows a number, and what one of it is in the base unit.

    Example:
        >>> shown("mm/K")
        ('µm/K', 0.001)
        >>> shown("1/K")
        ('µm/(m K)', 1e-06)
    """
    if unit == "1/K":
        return "µm/(m K)", 1e-6
    head, slash, tail = unit.partition("/")
    label, factor = _SHOWN.get(head, (head, 1.0))
    return label + slash + tail, factor
