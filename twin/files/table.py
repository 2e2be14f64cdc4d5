"""CSV tables at the border: columns by name, every fault with its line."""

import csv
import io
import math
from collections.abc import Iterable, Iterator, Sequence
from functools import cached_property
from pathlib import Path

import numpy as np
from pydantic_core import from_json

from matstd.twin.errors import BadFile
from matstd.twin.frames import Array, IntArray, Mask
from matstd.twin.words import did_you_mean

LARGEST_CELL = 1e12  # largest number of any column; larger ones are refused
COLDEST, HOTTEST, HOTTEST_HEATED = -60.0, 200.0, 500.0
"""Temperatures (degC) of a machine lie between the first two; a logger writes -9999 for none. A
sensor of what is heated, such as the nozzle of a printer, may go up to the third."""
MIN_HEATED_SHARE = 0.1
"""Share of the readings above `HOTTEST` from which it is hot there, unless the sensor is stuck."""
KELVIN = (240.0, 350.0)  # readings that all lie between are those of a room in kelvin
_BYTES_A_BLOCK = 1 << 13
"""Bytes that are converted at once: more of them leave the cache (2^17: 1.5 times as long)."""
_PLAIN = b"0123456789+-.eE \t"
_OTHERS = {"semicolons": ";", "tabs": "\t"}
_EXPECTED = "one cell for every column, commas between them, a point in decimal numbers"


def _rows(table: io.BytesIO, path: str | Path, first: int) -> Iterator[tuple[int, list[str]]]:
    """Rows that are not empty, with their line numbers."""
    reader = csv.reader(line.decode() for line in table)
    try:
        for row in reader:
            if any(row):
                yield first + reader.line_num - 1, row
    except csv.Error as error:
        line, found = first + reader.line_num - 1, f"a cell without an end ({error})"
        raise BadFile(path, line, found, "as many opening as closing quotes") from error


def _only_numbers(data: bytes, start: int, columns: int) -> Array | None:
    """Rows from a byte on that hold plain numbers alone, (N, columns); None where any does not.

    Such rows are a list of JSON without its brackets. Its reader gives the doubles of float() in
    0.08 µs a cell, where numpy.loadtxt takes 0.18 and csv with float() 0.9.
    """
    parts = []
    row = b"," * (columns - 1) + b"\n"
    while start < len(data):
        stop = data.find(b"\n", start + _BYTES_A_BLOCK) + 1 or len(data)
        block = data[start:stop].rstrip(b"\n")
        # what is left are commas and line ends, and what JSON would take for true, text or a list
        marks = block.translate(None, _PLAIN) + b"\n"
        if marks != row * (len(marks) // columns):
            return None
        try:
            values = from_json(b"[%b]" % block.replace(b"\n", b","))
            parts.append(np.array(values, dtype=float))
        except (ValueError, OverflowError):  # +1, .5, a whole number beyond a double
            return None
        start = stop
    return np.concatenate(parts).reshape(-1, columns) if parts else None


class CsvTable:
    """A table of text cells with the line number of every row.

    A table of plain numbers is read by blocks (a million rows of six in 0.5 s instead of 6 s); its
    cells are looked at one by one only where something in it is refused.

    Args:
        first_line: Line number of the header in the file.
    """

    def __init__(self, text: str, path: str | Path, first_line: int = 1) -> None:
        self.path = path
        self._data, self._first_line = text.encode(), first_line
        table = io.BytesIO(self._data)
        head = next(_rows(table, path, first_line), None)
        if head is None:
            raise BadFile(path, first_line, "nothing", "a line of column names")
        self.header_line, header = head
        self.columns = [name.strip() for name in header]
        other = next((name for name, mark in _OTHERS.items() if mark in header[0]), None)
        if len(header) == 1 and other is not None:
            raise BadFile(path, self.header_line, f"columns separated by {other}", _EXPECTED)
        for name in self.columns:
            if self.columns.count(name) > 1:
                raise BadFile(path, self.header_line, f"column {name} twice", "it once")
        self._values = _only_numbers(self._data, table.tell(), len(self.columns))
        self._count = len(self.rows if self._values is None else self._values)

    @cached_property
    def rows(self) -> list[tuple[int, list[str]]]:
        """Line number and cells of every row; raises BadFile where cells are missing."""
        _, *rows = _rows(io.BytesIO(self._data), self.path, self._first_line)
        for line, row in rows:
            if len(row) != len(self.columns):
                raise BadFile(self.path, line, _cells(row, self.columns), _EXPECTED)
        return rows

    @cached_property
    def lines(self) -> list[int]:
        """Line number of every row."""
        return [line for line, _ in self.rows]

    def reorder(self, order: IntArray) -> None:
        """Take the rows in another order; their line numbers go with them."""
        self.rows = [self.rows[i] for i in order]
        self.lines = [line for line, _ in self.rows]
        if self._values is not None:
            self._values = self._values[order]

    def __len__(self) -> int:
        return self._count

    def __contains__(self, name: str) -> bool:
        return name in self.columns

    def require(self, names: Iterable[str]) -> None:
        """Raise BadFile where columns are missing, all of them at once."""
        missing = [name for name in names if name not in self.columns]
        if missing:
            found = f"no column {' and no '.join(missing)} among {', '.join(self.columns)}"
            expected = f"{'a column' if len(missing) == 1 else 'columns'} {', '.join(missing)}"
            raise BadFile(self.path, self.header_line, found, expected)

    def allow_only(self, known: Sequence[str], pattern: str = "") -> None:
        """Raise BadFile for the first column that is not known."""
        for name in self.columns:
            if name not in known:
                found = f"column {name!r}{did_you_mean(name, known)}"
                expected = f"one of {', '.join(known)}{pattern}"
                raise BadFile(self.path, self.header_line, found, expected)

    def text(self, name: str) -> list[str]:
        """Cells of a column."""
        i = self.columns.index(name)
        return [row[i].strip() for _, row in self.rows]

    def numbers(
        self,
        name: str,
        empty: float | None = None,
        finite: bool = True,
        largest: float = LARGEST_CELL,
        smallest: float = -math.inf,
    ) -> Array:
        """Column as numbers, (N,); raises BadFile.

        Args:
            empty: What an empty cell means; None refuses it.
            finite: Whether NaN and infinity are refused.
            largest: Numbers beyond this, of either sign, are refused as slips.
            smallest: Numbers below this are refused.
        """
        if self._values is not None:
            out = self._values[:, self.columns.index(name)].copy()
            known = np.isfinite(out)
            wrong = (finite & ~known) | (known & (np.abs(out) > largest)) | (out < smallest)
            if not wrong.any():
                return out
        # the slow way names the line of the fault
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

    def temperatures(self, name: str) -> tuple[Array, Mask]:
        """A column of temperatures, (N,), degC, and where no sensor of a machine gives it, (N,)."""
        values = self.numbers(name, empty=math.nan, finite=False, largest=math.inf)
        known = values[np.isfinite(values)]
        hot = known[(known > HOTTEST) & (known <= HOTTEST_HEATED)]
        is_kelvin = bool(np.all((known > KELVIN[0]) & (known < KELVIN[1])))
        is_heated = (
            len(hot) > MIN_HEATED_SHARE * len(known) and len(np.unique(hot)) > 2 and not is_kelvin
        )
        top = HOTTEST_HEATED if is_heated else HOTTEST
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
