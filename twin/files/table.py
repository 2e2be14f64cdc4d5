"""CSV tables at the border: columns by name, every fault with its line."""

import csv
import io
import math
from collections.abc import Iterable, Sequence
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from twin.errors import BadFile
from twin.frames import Array
from twin.words import did_you_mean

LARGEST = 1e12
"""Whatever a column holds, a number beyond this is a slip."""

COLDEST, HOTTEST, NOZZLE = -60.0, 200.0, 500.0
"""Temperatures (degC) of a machine lie between the first two; a logger writes -9999 for none. A
sensor of what is heated, such as the nozzle of a printer, may go up to the third."""

HEATED = 0.1
"""Share of the readings above `HOTTEST` from which it is hot there, unless the sensor is stuck."""

KELVIN = (240.0, 350.0)
"""Readings that all lie between are those of a room in kelvin."""

_OTHERS = {"semicolons": ";", "tabs": "\t"}
_EXPECTED = "a cell a column, commas between them, and a point in decimal numbers"


def _rows(text: str, path: str | Path, first_line: int) -> list[tuple[int, list[str]]]:
    """Rows that are not empty, with their line numbers."""
    reader = csv.reader(io.StringIO(text))
    try:
        return [(first_line + reader.line_num - 1, row) for row in reader if any(row)]
    except csv.Error as error:
        line = f"line {first_line + reader.line_num - 1}"
        found = f"a cell without an end ({error})"
        raise BadFile(path, line, found, "as many opening as closing quotes") from error


class CsvTable:
    """A table of text cells with the line number of every row.

    Args:
        text: The table with its header line.
        path: The file, for messages.
        first_line: Line number of the header in the file.
    """

    def __init__(self, text: str, path: str | Path, first_line: int = 1) -> None:
        self.path = path
        rows = _rows(text, path, first_line)
        if not rows:
            raise BadFile(path, f"line {first_line}", "nothing", "a line of column names")
        self.header_line, header = rows[0]
        self.columns = [name.strip() for name in header]
        other = next((name for name, mark in _OTHERS.items() if mark in header[0]), None)
        if len(header) == 1 and other is not None:
            where = f"line {self.header_line}"
            raise BadFile(path, where, f"columns parted by {other}", _EXPECTED)
        for name in self.columns:
            if self.columns.count(name) > 1:
                raise BadFile(path, f"line {self.header_line}", f"column {name} twice", "it once")
        self.lines = [line for line, _ in rows[1:]]
        self.cells = [row for _, row in rows[1:]]
        for line, row in zip(self.lines, self.cells, strict=True):
            if len(row) != len(self.columns):
                raise BadFile(path, f"line {line}", _cells(row, self.columns), _EXPECTED)

    def reorder(self, order: NDArray[np.int64]) -> None:
        """Take the rows in another order; their line numbers go with them."""
        self.lines = [self.lines[i] for i in order]
        self.cells = [self.cells[i] for i in order]

    def __len__(self) -> int:
        return len(self.cells)

    def __contains__(self, name: str) -> bool:
        return name in self.columns

    def require(self, names: Iterable[str]) -> None:
        """Raise BadFile where columns are missing, all of them at once."""
        missing = [name for name in names if name not in self.columns]
        if missing:
            expected = ", ".join(missing)
            raise BadFile(
                self.path,
                f"line {self.header_line}",
                f"no column {' and no '.join(missing)} among {', '.join(self.columns)}",
                f"a column {expected}" if len(missing) == 1 else f"columns {expected}",
            )

    def allow_only(self, known: Sequence[str], pattern: str = "") -> None:
        """Raise BadFile for the first column that is not known."""
        for name in self.columns:
            if name not in known:
                meant = did_you_mean(name, known)
                raise BadFile(
                    self.path,
                    f"line {self.header_line}",
                    f"column {name!r}{meant}",
                    f"one of {', '.join(known)}{pattern}",
                )

    def text(self, name: str) -> list[str]:
        """Cells of a column."""
        i = self.columns.index(name)
        return [row[i].strip() for row in self.cells]

    def numbers(
        self,
        name: str,
        empty: float | None = None,
        finite: bool = True,
        largest: float = LARGEST,
        smallest: float = -math.inf,
    ) -> Array:
        """Column as numbers, (N,).

        Args:
            name: The column.
            empty: What an empty cell means; None refuses it.
            finite: Whether NaN and infinity are refused.
            largest: Numbers beyond this, of either sign, are refused as slips.
            smallest: Numbers below this are refused.

        Raises:
            BadFile: Line, what stood there.
        """
        out = np.empty(len(self))
        for i, cell in enumerate(self.text(name)):
            if not cell and empty is not None:
                out[i] = empty
                continue
            try:
                out[i] = _plain(cell)
            except ValueError:
                out[i] = math.nan
                if finite or cell:
                    expected = "a decimal point" if _has_comma(cell) else "a number"
                    raise self.bad(i, name, repr(cell), expected) from None
            if finite and not math.isfinite(out[i]):
                raise self.bad(i, name, cell, "a finite number")
            if abs(out[i]) > largest and math.isfinite(out[i]):
                raise self.bad(i, name, cell, f"at most {largest:.6g}")
            if out[i] < smallest:
                raise self.bad(i, name, cell, f"{smallest:g} or more")
        return out

    def temperatures(self, name: str) -> tuple[Array, NDArray[np.bool_]]:
        """A column of temperatures, (N,), degC, and where no sensor of a machine gives it, (N,)."""
        values = self.numbers(name, empty=math.nan, finite=False, largest=math.inf)
        known = values[np.isfinite(values)]
        hot = known[(known > HOTTEST) & (known <= NOZZLE)]
        is_kelvin = bool(np.all((known > KELVIN[0]) & (known < KELVIN[1])))
        is_heated = len(hot) > HEATED * len(known) and len(np.unique(hot)) > 2 and not is_kelvin
        top = NOZZLE if is_heated else HOTTEST
        return values, ~((values >= COLDEST) & (values <= top))

    def bad(self, row: int, name: str, found: object, expected: str) -> BadFile:
        """The exception for a cell."""
        return BadFile(self.path, f"line {self.lines[row]}, column {name}", found, expected)


def _cells(row: Sequence[str], columns: Sequence[str]) -> str:
    """What is wrong with a row that has more or fewer cells than the header."""
    found = f"{len(row)} cells under {len(columns)} column names"
    if len(row) < len(columns):
        return f"{found} (is the row cut off?)"
    return f"{found} (a decimal comma makes two cells of one number)"


def _has_comma(cell: str) -> bool:
    """Whether a cell would be a number if its comma were a point."""
    try:
        _plain(cell.replace(",", ".", 1))
    except ValueError:
        return False
    return "," in cell


def _plain(cell: str) -> float:
    """Number of a cell; float() alone also reads 1_0 as ten, and digits of other scripts."""
    if "_" in cell or not cell.isascii():
        raise ValueError(cell)
    return float(cell)
