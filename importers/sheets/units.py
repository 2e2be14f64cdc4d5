"""Units behind the names of columns: `Deviation [µm]`, `x_mm`, `Soll X (mm)`, `nut °C`."""

import math
import re

from matstd.twin.units import HOUR, MINUTE

MM = {"mm": 1.0, "µm": 1e-3, "um": 1e-3, "micron": 1e-3, "nm": 1e-6, "m": 1e3, "in": 25.4}
"""Units of length, mm."""
ANGLES = {"deg": math.pi / 180.0, "°": math.pi / 180.0, "rad": 1.0, "mrad": 1e-3, "µrad": 1e-6,
          "urad": 1e-6, "arcsec": math.pi / 648000.0, '"': math.pi / 648000.0}  # fmt: skip
"""Units of angles, rad."""
SECONDS = {"s": 1.0, "sec": 1.0, "ms": 1e-3, "min": MINUTE, "h": HOUR}  # units of time, s
DEGC = ("°C", "degC", "deg C")  # units of temperature

_UNIT = re.compile(
    r"[\s_]*[\[(]\s*([^\])]+?)\s*[\])]\s*\Z|[\s_/]*(°C|deg ?C)\Z|[\s_/]+([A-Za-zµμ°]+)\Z"
)


def parted(column: str) -> tuple[str, str]:
    """Name of a column and what may be its unit: in brackets behind it, or its last word.

    Example:
        >>> parted("tau2 [Nm]"), parted("T_nut_degC"), parted("point_name"), parted("dx")
        (('tau2', 'Nm'), ('T_nut', 'degC'), ('point', 'name'), ('dx', ''))
    """
    match = _UNIT.search(column)
    if match is None:
        return column.strip(), ""
    return column[: match.start()].strip(), match[match.lastindex or 0].replace("μ", "µ")


def unit_of_column(column: str) -> str | None:
    """Unit of length or angle behind the name of a column, None where none stands there.

    Example:
        >>> unit_of_column("Deviation [µm]"), unit_of_column("x_mm"), unit_of_column("point_name")
        ('µm', 'mm', None)
    """
    unit = parted(column)[1]
    return unit if unit in MM or unit in ANGLES else None


def bare(column: str) -> str:
    """Name of a column without the unit of length or angle behind it.

    Example:
        >>> bare("Deviation [µm]"), bare("x_mm"), bare("Soll X (mm)"), bare("1 up µm")
        ('Deviation', 'x', 'Soll X', '1 up')
    """
    return parted(column)[0] if unit_of_column(column) else column.strip()


def is_unit(cell: str) -> bool:
    """Whether a cell of a header holds a unit of length or angle alone, `[mm]`, `µm`."""
    word = cell.strip("[]() ").replace("μ", "µ")
    return word in MM or word in ANGLES
