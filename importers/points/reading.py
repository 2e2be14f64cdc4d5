"""Lists of nominal and measured coordinates: a machined part, or a calibrated plate.

Both compare the actual with the nominal place of a point, with opposite signs:

- ``part``: the machine under test made the point, a better one measured it. Measured minus nominal
  is where the tool really went relative to the workpiece: the machine's own deviation. A controller
  that believes in the nominal machine sees such a surface outside its place by the negative.
- ``standard``: the point is calibrated, the machine under test measured it. Measured minus
  calibrated is what the controller believes, with its sign.
"""

import re
from typing import Literal

import numpy as np

from matstd.importers.points.coordinate_rows import (
    letters_of_rows,
    nominal_and_measured,
    points_of_rows,
)
from matstd.importers.points.point_list import PointList
from matstd.importers.sheets import MM, Sheet, signs
from matstd.twin.errors import BadFile
from matstd.twin.frames import Array

Meaning = Literal["part", "standard"]  # what a list is of: see the module

_NOMINAL = re.compile(r"nom|soll|target|calib|ref|theor|théor|cad", re.IGNORECASE)
_MEASURED = re.compile(r"meas|act|ist\b|\bist|gemessen|mesur|réel|cmm|found", re.IGNORECASE)
_DEVIATION = re.compile(r"dev|err|abweich|fehler|écart|\bd[xyz]\b|delta", re.IGNORECASE)
_AFTER_DIR = re.compile(r"\b(dir)(?=[xyz]\b)", re.IGNORECASE)
_LETTER = re.compile(r"(?<![a-z])d?([xyz])(?![a-z])", re.IGNORECASE)
_APPROACH = re.compile(r"dir|richtung|approach|anfahr|revers|umkehr", re.IGNORECASE)
_ROLES = (
    ("approach", _APPROACH),
    ("measured", _MEASURED),
    ("deviation", _DEVIATION),
    ("nominal", _NOMINAL),
)
"""What a column of a coordinate holds, by its name: the first that fits."""
_NAME = re.compile(
    r"name|label|feature|hole|point|element|bohrung|merkmal|élément|trou|alésage|\bid\b",
    re.IGNORECASE,
)
_SETUP = re.compile(r"set-?up|part|session|date|day|aufspannung|werkst", re.IGNORECASE)


def read_points(sheet: Sheet, unit: str | None = None) -> PointList:
    """Points from a table with columns such as `x nominal [mm]`, `x measured [mm]`.

    Deviations (`dx [µm]`) may stand in place of measured coordinates. A coordinate without a
    column is zero and not measured. A row may also hold one coordinate of a point, whose letter
    stands in a column of its own, as reports of CMMs are laid out.

    Args:
        unit: Unit of columns whose name has none; None: mm for coordinates, deviations are refused.

    Raises:
        BadFile: No nominal or no measured coordinate; a deviation without a unit.
    """
    letters = letters_of_rows(sheet)
    if letters is not None:
        return _by_coordinate(sheet, letters, unit)
    nominal = np.zeros((len(sheet), 3))
    deviation = np.full((len(sheet), 3), np.nan)
    approach = np.zeros((len(sheet), 3), dtype=np.int64)
    found = _roles(sheet)
    for i, letter in enumerate("xyz"):
        if ("approach", letter) in found:
            approach[:, i] = signs(sheet, found["approach", letter])
        at = found.get(("nominal", letter))
        if at is not None:
            nominal[:, i] = sheet.quantity(at, MM, unit or "mm")
        if ("measured", letter) in found:
            measured = sheet.quantity(found["measured", letter], MM, unit or "mm")
            deviation[:, i] = measured - np.nan_to_num(nominal[:, i])
        elif ("deviation", letter) in found:
            deviation[:, i] = sheet.quantity(found["deviation", letter], MM, unit)
        # only now: a coordinate without a measurement needs no nominal value
        if at is not None:
            nominal[:, i] = _stated(sheet, at, nominal[:, i], deviation[:, i])
    if not np.isfinite(deviation).any() or not any(role == "nominal" for role, _ in found):
        raise sheet.lacking(
            "columns such as 'x nominal [mm]' and 'x measured [mm]', or a mapping file"
        )
    return PointList(
        nominal=nominal,
        deviation=deviation,
        feature=np.array(_texts(sheet, _NAME, "")),
        setup=np.array(_texts(sheet, _SETUP, "a")),
        line=np.array(sheet.lines),
        approach=approach,
    )


def _by_coordinate(sheet: Sheet, letters: list[str], unit: str | None) -> PointList:
    """Points of a table with a row a coordinate."""
    columns = nominal_and_measured(sheet, _NOMINAL, _MEASURED)
    nominal, measured = (sheet.quantity(c, MM, unit or "mm") for c in columns)
    is_point = np.array([letter != "" for letter in letters])
    nominal = _stated(sheet, columns[0], nominal, np.where(is_point, measured, np.nan))
    setup = _texts(sheet, _SETUP, "a")
    label, points = points_of_rows(sheet, letters, _texts(sheet, _NAME, ""), setup)
    at, off = np.zeros((len(points), 3)), np.full((len(points), 3), np.nan)
    for p, point in enumerate(points):
        for letter, k in point.items():
            i = "XYZ".index(letter)
            at[p, i], off[p, i] = nominal[k], measured[k] - nominal[k]
    first = [next(iter(point.values())) for point in points]
    return PointList(
        nominal=at,
        deviation=off,
        feature=np.array([label[k] for k in first]),
        setup=np.array([setup[k] for k in first]),
        line=np.array([sheet.lines[k] for k in first]),
        approach=np.zeros((len(points), 3), dtype=np.int64),
    )


def _stated(sheet: Sheet, column: int, nominal: Array, found: Array) -> Array:
    """Nominal coordinates, 0 where neither stands; raises BadFile where one was measured alone."""
    alone = np.flatnonzero(np.isfinite(found) & ~np.isfinite(nominal))
    if len(alone):
        expected = "the nominal coordinate of what was measured"
        raise sheet.bad(int(alone[0]), column, "nothing", expected)
    return np.nan_to_num(nominal)


def _roles(sheet: Sheet) -> dict[tuple[str, str], int]:
    """Column of every role and letter."""
    found: dict[tuple[str, str], int] = {}
    for i, name in enumerate(sheet.names):
        letter = _LETTER.search(_AFTER_DIR.sub(r"\1 ", name.replace("_", " ")))
        if letter is None:
            continue
        is_plain = name.strip().lower() == letter[1].lower()
        words = name.replace("_", " ")
        role = next((role for role, pattern in _ROLES if pattern.search(words)), None)
        role = "nominal" if role is None and is_plain else role
        if role is None:
            continue
        key = (role, letter[1].lower())
        if key in found:
            both = f"{sheet.columns[found[key]]!r} and {sheet.columns[i]!r}"
            raise BadFile(sheet.path, "header", both, f"one column of {role} {key[1]}")
        found[key] = i
    return found


def _texts(sheet: Sheet, pattern: re.Pattern[str], empty: str) -> list[str]:
    """Cells of the first column that a pattern names and that holds no coordinate."""
    found = sheet.find(pattern, _LETTER)
    cells = [""] * len(sheet) if found is None else sheet.text(found)
    return [text or empty for text in cells]
