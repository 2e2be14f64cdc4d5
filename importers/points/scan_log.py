"""Logs of scanning probes: positions over time, and the deflection of the stylus if it is apart.

    x, y, z                  positions of the ball (Renishaw SPRINT gives them deflected), or
    x, y, z, dx, dy, dz      positions of the machine and the deflection along its axes, or
    x, y, z, d               positions of the machine and the deflection along the normal of the
                             surface, towards the probe (Blum Digilog)

Further columns: `line` (number of the line; without it one ends where points stop), `t` (time), and
readings of rotary axes by their letters. Names of columns may be in capitals, with units behind.
"""

import re
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from matstd.importers.sheets import ANGLES, MM, Sheet, read_sheet
from matstd.twin.errors import BadFile
from matstd.twin.frames import Array, IntArray

_LINE = r"line|scan|pass|track|bahn|zeile"
_TIME = r"(?:t|time|zeit|timestamp)(?:[\s_]*[\[(]?(?:ms|sec|s)[\])]?)?"
_DEFLECTION = r"d|deflection|auslenkung|signal|w"
_SECONDS = {"s": 1.0, "sec": 1.0, "ms": 1e-3, "": 1.0}
_FEWEST_POINTS = 10  # points of a scan


@dataclass(frozen=True, eq=False)
class ScanLog:
    """Points of one scan in the order of time."""

    path: Path  # of the file
    row: IntArray  # line of every point in the file, (N,)
    line: IntArray  # number of the line of the scan, (N,); all 1 where the file has none
    position: Array  # coordinates of the ball, (N, 3), mm
    # along the surface's normal, to be added to the distance of the ball, (N,), mm
    deflection: Array
    rotary: Mapping[str, Array]  # readings of rotary axes that the file has, by letter, (N,), rad
    time: Array  # since the first point, (N,), s; zeros where the file has none
    is_numbered: bool  # whether the file numbers its lines


def read_scan_log(path: str | Path) -> ScanLog:
    """The points of a scan; lengths are in mm unless their names say other units.

    Raises:
        BadFile: No table with x, y, z, an empty cell, time that runs back, or too few points.
    """
    sheet = read_sheet(path)
    found = {letter: _column(sheet, letter) for letter in "xyz"}
    if None in found.values():
        missing = ", ".join(name for name, column in found.items() if column is None)
        raise BadFile(
            path, "header", f"{', '.join(sheet.columns)}", f"a column {missing}; with --columns too"
        )
    if len(sheet) < _FEWEST_POINTS:
        raise BadFile(path, "table", f"{len(sheet)} points", f"{_FEWEST_POINTS} or more of a scan")
    position = np.column_stack([_lengths(sheet, found[letter]) for letter in "xyz"])
    apart = [_column(sheet, f"d{letter}") for letter in "xyz"]
    if None not in apart:
        position += np.column_stack([_lengths(sheet, column) for column in apart])
    along = _column(sheet, _DEFLECTION)
    line, time = _column(sheet, _LINE), _column(sheet, _TIME)
    rotary = {letter: _column(sheet, letter.lower()) for letter in "ABC"}
    return ScanLog(
        path=Path(path),
        row=np.array(sheet.lines, dtype=np.int64),
        line=np.ones(len(sheet), dtype=np.int64) if line is None else _numbers(sheet, line),
        position=position,
        deflection=np.zeros(len(sheet)) if along is None else _lengths(sheet, along),
        rotary={
            letter: _complete(sheet, column, sheet.quantity(column, ANGLES, "deg"))
            for letter, column in rotary.items()
            if column is not None
        },
        time=np.zeros(len(sheet)) if time is None else _times(sheet, time),
        is_numbered=line is not None,
    )


def _column(sheet: Sheet, names: str) -> int | None:
    """The column with one of some names, without its unit."""
    return sheet.find(re.compile(rf"\A(?:{names})\Z", re.IGNORECASE))


def _lengths(sheet: Sheet, column: int | None) -> Array:
    """Lengths of a column, (N,), mm."""
    assert column is not None
    return _complete(sheet, column, sheet.quantity(column, MM, "mm"))


def _numbers(sheet: Sheet, column: int) -> IntArray:
    """Whole numbers of a column, (N,)."""
    _complete(sheet, column, sheet.numbers(column))
    return sheet.whole_numbers(column, "a whole number")


def _times(sheet: Sheet, column: int) -> Array:
    """Seconds since the first point, (N,), which must not run back."""
    time = _complete(sheet, column, sheet.numbers(column))
    unit = re.search(r"[\[(_ ](ms|sec|s)[\])]?\Z", sheet.columns[column])
    time = (time - time[0]) * _SECONDS[unit[1] if unit else ""]
    back = np.flatnonzero(np.diff(time) < 0.0)
    if len(back):
        at = int(back[0]) + 1
        raise sheet.bad(at, column, f"{time[at]:g} s after {time[at - 1]:g} s", "rising times")
    return time


def _complete(sheet: Sheet, column: int, values: Array) -> Array:
    """A column without empty cells."""
    empty = np.flatnonzero(~np.isfinite(values))
    if len(empty):
        raise sheet.bad(int(empty[0]), column, "an empty cell", "a number in every row of a scan")
    return values
