"""Text tables whose columns are separated by blanks only."""

import re
from collections import Counter

from matstd.importers.sheets.rows import filled_lines

_WIDE = re.compile(r"\s{2,}|\t")
_NUMBER = re.compile(r"[+-]?(\d+[.,]?\d*|[.,]\d+)([eE][+-]?\d+)?\Z")
MIN_EQUAL_ROWS = 0.8  # share of the rows of numbers that must have the same number of columns


def by_blanks(text: str) -> list[tuple[int, list[str]]]:
    r"""Rows of a table separated by blanks, each with its line; empty for any other text.

    Words of one cell stand a blank apart, columns two or more; where numbers stand closer every
    blank parts them, and of a header with twice as many words two make a name (`Meas X Meas Y`).

    Example:
        >>> by_blanks("  Nom X    Meas X\n  10.0     10.1\n  20.0     20.2\n")
        [(1, ['Nom X', 'Meas X']), (2, ['10.0', '10.1']), (3, ['20.0', '20.2'])]
    """
    lines = filled_lines(text)
    narrow = {i: line.split() for i, line in lines}
    data = [i for i, _ in lines if len(narrow[i]) > 1 and _are_numbers(narrow[i])]
    if len(data) < 2:
        return []
    wide = {i: _WIDE.split(line) for i, line in lines}
    for cells in (wide, narrow):
        width, count = Counter(len(cells[i]) for i in data).most_common(1)[0]
        least = MIN_EQUAL_ROWS * len(data)
        if width > 1 and min(count, sum(_are_numbers(cells[i]) for i in data)) >= least:
            return [(i, _row(wide[i], narrow[i], cells[i], i in data, width)) for i, _ in lines]
    return []


def _row(
    wide: list[str], narrow: list[str], own: list[str], is_data: bool, width: int
) -> list[str]:
    """Cells of one line: of a row of numbers as they are, of a header as many as it has columns."""
    if is_data or len(wide) == width:
        return own if is_data else wide
    if len(narrow) == width:
        return narrow
    if len(narrow) == 2 * width:
        return [f"{a} {b}" for a, b in zip(narrow[::2], narrow[1::2], strict=True)]
    return wide


def _are_numbers(cells: list[str]) -> bool:
    """Whether more than half of the cells are numbers."""
    return 2 * sum(bool(_NUMBER.match(c)) for c in cells) > len(cells)
