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

GPA = 1e3
"""One gigapascal in N/mm^2."""

MINUTE, HOUR, DAY = 60.0, 3600.0, 86400.0
"""In s."""

T_REF = 20.0
"""Reference temperature of geometrical specifications, degC (ISO 1)."""
