"""Reader of points that a coordinate measuring machine took on a standard."""

import re
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from matstd.artefact.body import Standard
from matstd.importers.sheets import MM, Sheet, bare, read_sheet, unit_of_column
from matstd.twin.errors import BadFile
from matstd.twin.frames import Array
from matstd.twin.record import Labels

STAMP = "MATSTD"
"""Word before the fingerprint of the standard, in emitted programs and in their results."""

_STAMPED = re.compile(rf"{STAMP} ([0-9a-f]{{16}})")
_NUMBERED = re.compile(r"(.+)_\d+\Z")
_FEATURE = ("feature", "name", "element", "label", "point")
SIDES = ("DATUM_B", "DATUM_C")
"""Datums that the program touches by hand; a list of all points may include them."""

_DIAMETER = ("diameter", "d", "dia")


@dataclass(frozen=True, eq=False)
class CmmPoints:
    """Points on features, in the frame of the CMM's part alignment."""

    path: Path
    feature: Labels  # name of the feature of every point, (N,)
    point: Array  # on the surface, or the centre of a ball where a diameter is given, (N, 3), mm
    diameter: Array  # of a ball that was evaluated by the CMM, (N,), mm; nan for a point
    line: np.ndarray  # line number in the file, (N,)
    remarks: tuple[str, ...]


def read_cmm_points(path: str | Path, standard: Standard) -> CmmPoints:
    """Points of a standard from any table with a column of features and x, y, z.

    Names may be numbered (`FF1_017`). A line above the header may hold the stamp of an emitted
    program.

    Args:
        standard: As designed; the one that was measured.

    Raises:
        BadFile: Missing columns, an unknown feature, or the stamp of another standard.
    """
    sheet = read_sheet(path)
    remarks = _checked_stamp(sheet, standard)
    column = _column(sheet, _FEATURE, "the feature")
    names = [_feature(n, standard) for n in sheet.text(column)]
    for name, line in zip(names, sheet.lines, strict=True):
        if name not in (*standard.features, *SIDES):
            raise BadFile(path, line, f"feature {name!r}", f"one of {', '.join(standard.features)}")
    xyz = []
    for letter in "xyz":
        k = _column(sheet, (letter, f"{letter} actual", f"{letter} measured"), letter)
        unit = unit_of_column(sheet.columns[k])
        if unit is None:
            remarks.append(f"column {sheet.columns[k]!r} names no unit: taken as mm")
        xyz.append(sheet.numbers(k) * MM.get(unit or "mm", 1.0))
    point = np.stack(xyz, axis=1)
    if len(gaps := np.flatnonzero(~np.isfinite(point).all(axis=1))):
        raise BadFile(path, sheet.lines[gaps[0]], "no number", "x, y and z")
    wide = [k for k, c in enumerate(sheet.columns) if _bare(c) in _DIAMETER]
    diameter = sheet.numbers(wide[0]) if wide else np.full(len(sheet), np.nan)
    if wide:
        diameter = diameter * MM.get(unit_of_column(sheet.columns[wide[0]]) or "mm", 1.0)
    return CmmPoints(
        path=Path(path),
        feature=np.array(names),
        point=point,
        diameter=diameter,
        line=np.array(sheet.lines),
        remarks=tuple(remarks),
    )


def _checked_stamp(sheet: Sheet, standard: Standard) -> list[str]:
    """Reject points of another standard; a remark where no stamp names the standard."""
    for text in sheet.title:
        if found := _STAMPED.search(text):
            if found[1] != standard.fingerprint:
                raise BadFile(
                    sheet.path,
                    "head",
                    f"standard {found[1]}",
                    f"{standard.fingerprint}, the fingerprint of '{standard.name}'",
                )
            return []
    return [f"{sheet.path} does not say which standard was measured: taken as '{standard.name}'"]


def _feature(name: str, standard: Standard) -> str:
    """A feature by its name, or by the name of a numbered point on it."""
    numbered = _NUMBERED.match(name)
    known = (*standard.features, *SIDES)
    return numbered[1] if numbered and name not in known else name


def _bare(column: str) -> str:
    """Name of a column without its unit, in small letters."""
    return bare(column).lower().replace("_", " ")


def _column(sheet: Sheet, names: tuple[str, ...], what: str) -> int:
    """Index of the first column with one of some names; raises BadFile."""
    for k, column in enumerate(sheet.columns):
        if _bare(column) in names:
            return k
    raise BadFile(
        sheet.path, "header", f"no column of {what}", f"'{names[0]}' in {', '.join(sheet.columns)}"
    )
