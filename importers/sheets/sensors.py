"""Recorded columns: temperatures, loads, and quantities of any other unit."""

import re

import numpy as np

from matstd.importers.sheets.sheet import Sheet
from matstd.importers.sheets.units import ANGLES, DEGC, MM, SECONDS, parted
from matstd.twin.frames import Array

_TILT = re.compile(r"tilt|incl|neig|level|libelle", re.IGNORECASE)
"""Names of channels of levels and inclinometers."""
_LOAD = re.compile(r"F_?([xyz])\Z", re.IGNORECASE)


def temperatures(sheet: Sheet) -> dict[str, Array]:
    """Columns of temperatures by the name of the sensor, each (N,), degC."""
    out = {}
    for i, column in enumerate(sheet.columns):
        name, unit = parted(column)
        if unit in DEGC:
            out[_word(name).removeprefix("T_") or f"column{i + 1}"] = sheet.numbers(i)
    return out


def loads(sheet: Sheet) -> Array | None:
    """Load on the tool, (N, 3), N, of columns `Fx [N]`; None where there are none."""
    each = [(i, *parted(column)) for i, column in enumerate(sheet.columns)]
    found = {m[1].lower(): i for i, n, unit in each if unit == "N" and (m := _LOAD.match(n))}
    if not found:
        return None
    zero = np.zeros(len(sheet))
    return np.stack([sheet.numbers(found[c]) if c in found else zero for c in "xyz"], axis=1)


def own_columns(sheet: Sheet) -> dict[str, Array]:
    """Whole columns of numbers with any other unit in brackets, `tau2 [Nm]`, that nothing used.

    Columns of lengths and angles may hold what was measured, so only tilts are taken of those.

    By name and unit as a run has them (`tau2_Nm`), (N,); they may drive any effect.
    """
    known = (*MM, *ANGLES, *SECONDS, *DEGC)
    out = {}
    for i, column in enumerate(sheet.columns):
        name, unit = map(_word, parted(column))
        is_other = column.endswith((")", "]")) and (
            parted(column)[1] not in known or (parted(column)[1] in ANGLES and _TILT.search(column))
        )
        is_whole = all(isinstance(row[i], float) for row in sheet.cells)
        if i not in sheet.used and is_other and is_whole and name and unit:
            out[f"{name}_{unit}"] = sheet.numbers(i)
    return out


def _word(text: str) -> str:
    return re.sub(r"\W+", "_", text).strip("_")
