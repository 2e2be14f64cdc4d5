"""A table as text and numbers: its columns by name, its cells with their lines."""

import re
from collections.abc import Mapping
from dataclasses import dataclass, field
from functools import cached_property
from pathlib import Path

import numpy as np

from matstd.importers.sheets.units import bare, unit_of_column
from matstd.twin.errors import BadFile
from matstd.twin.frames import Array, IntArray

LARGEST_CELL = 1e15
"""Largest number of a cell: above milliseconds of a clock, and squares do not overflow."""


@dataclass(frozen=True)
class Sheet:
    """One table of a foreign file."""

    path: Path
    columns: tuple[str, ...]  # names in its header, with their units as they stand there
    # rows of numbers, each as long as `columns`; "" where a cell is empty
    cells: tuple[tuple[str | float, ...], ...]
    lines: tuple[int, ...]  # line or row of the file that each of them stands in
    title: tuple[str, ...] = ()  # lines above the header
    left_out: tuple[int, ...] = ()  # lines below the header that hold no row of numbers
    # for each row the words above its block of numbers, such as the names of parts
    above: tuple[str, ...] = ()
    # rows among those of numbers that hold words, with their lines
    of_words: tuple[tuple[int, tuple[str | float, ...]], ...] = ()
    sheet: str = ""  # of a workbook
    number: int = 1  # in the order of the tables of the file
    used: set[int] = field(default_factory=set, compare=False, repr=False)  # columns that were read

    def __len__(self) -> int:
        return len(self.cells)

    @property
    def count(self) -> int:
        """Numbers in the table."""
        return sum(isinstance(cell, float) for row in self.cells for cell in row)

    @cached_property
    def names(self) -> tuple[str, ...]:
        """Names of the columns without their units."""
        return tuple(map(bare, self.columns))

    def numbers(self, column: int, missing: float | None = None) -> Array:
        """Numbers of a column, (N,); NaN where a cell is empty or `missing`; raises BadFile."""
        self.used.add(column)
        out = np.full(len(self), np.nan)
        for i, row in enumerate(self.cells):
            cell = row[column]
            if isinstance(cell, str) and cell:
                expected = "a number" if "," not in cell else "one decimal mark in the whole file"
                raise self.bad(i, column, repr(cell), expected)
            if cell != "" and cell != missing:
                if abs(float(cell)) > LARGEST_CELL:
                    raise self.bad(i, column, f"{cell:g}", f"{LARGEST_CELL:g} at most")
                out[i] = cell
        return out

    def quantity(
        self, column: int, units: Mapping[str, float], otherwise: str | None = None
    ) -> Array:
        """Numbers of a column in base units, (N,), by the unit behind its name.

        Raises:
            BadFile: None of `units`, or no unit where none is stated by `otherwise`.
        """
        unit = unit_of_column(self.columns[column]) or otherwise
        if unit is None or unit not in units:
            found = f"column {self.columns[column]!r} in {unit or 'an unknown unit'}"
            expected = f"one of {', '.join(units)} behind the name, or --unit"
            raise BadFile(self.path, "header", found, expected)
        return self.numbers(column) * units[unit]

    def whole_numbers(self, column: int, what: str) -> IntArray:
        """Whole numbers of a column, (N,); raises BadFile, which expects `what`."""
        numbers = self.numbers(column)
        odd = np.flatnonzero(~np.isfinite(numbers) | (numbers != np.round(numbers)))
        if len(odd):
            raise self.bad(int(odd[0]), column, f"{numbers[odd[0]]:g}", what)
        return numbers.astype(np.int64)

    def text(self, column: int) -> list[str]:
        """Cells of a column as text; whole numbers without a decimal mark."""
        self.used.add(column)
        return self.cells_as_text(column)

    def cells_as_text(self, column: int) -> list[str]:
        """The same without counting the column as used."""
        return [f"{c:g}" if isinstance(c := row[column], float) else c for row in self.cells]

    @property
    def unused(self) -> tuple[str, ...]:
        """Named, non-empty columns that were not read."""
        rest = [i for i, name in enumerate(self.columns) if name and i not in self.used]
        return tuple(self.columns[i] for i in rest if any(self.cells_as_text(i)))

    def find(self, pattern: re.Pattern[str], *without: re.Pattern[str]) -> int | None:
        """The first column whose name matches one pattern and none of the others."""
        for i, name in enumerate(self.names):
            if pattern.search(name) and not any(w.search(name) for w in without):
                return i
        return None

    def column(self, name: str) -> int:
        """Index of a column by its whole name or its name without unit; raises BadFile."""
        for names in (self.columns, self.names):
            if names.count(name) > 1:
                twice = [self.columns[i] for i, other in enumerate(names) if other == name]
                found = f"{name!r} in columns {' and '.join(map(repr, twice[:2]))}"
                raise BadFile(self.path, "header", found, "one column of that name")
            if name in names:
                return names.index(name)
        expected = f"one of {', '.join(self.columns)}"
        raise BadFile(self.path, "header", f"no column {name!r}", expected)

    def bad(self, row: int, column: int, found: str, expected: str) -> BadFile:
        """The exception for a cell."""
        where = f"line {self.lines[row]}, column {self.columns[column]!r}"
        return BadFile(self.path, where, found, expected)

    def lacking(self, expected: str) -> BadFile:
        """The exception for columns among which something is missing."""
        found = f"columns {', '.join(map(repr, self.columns))}"
        return BadFile(self.path, "header", found, expected)
