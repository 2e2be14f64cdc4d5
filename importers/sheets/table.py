"""Reader of foreign tables: workbooks, and text with any separator and decimal mark.

The table is found by its rows of numbers: the first one ends the header, words above are the title,
words below the last one a footer (means, remarks).
"""

import csv
import io
import re
from collections import Counter
from collections.abc import Callable, Sequence
from dataclasses import replace
from pathlib import Path

import numpy as np

from matstd.importers.sheets.channel_log import by_channels
from matstd.importers.sheets.height_map import by_heights
from matstd.importers.sheets.rows import filled_lines
from matstd.importers.sheets.several_tables import Row, axis_in, separate_tables
from matstd.importers.sheets.sheet import Sheet
from matstd.importers.sheets.units import is_unit
from matstd.twin.errors import BadFile, DesignError
from matstd.twin.files import read_any_text

WORKBOOKS = (".xlsx", ".xlsm", ".xlsb", ".xls", ".ods")
"""Endings of files that are read as workbooks."""
_SEPARATORS = (";", "\t", ",", "|")
"""In the order of trial: a comma late, because it may be a decimal mark."""
MIN_NUMBER_SHARE = 0.6  # from this share of numbers a column is one of numbers
MAX_LISTED_TABLES, MAX_LISTED_NAMES = 12, 6  # tables, and columns of each, that a message lists
_RULE = re.compile(r":?-{2,}:?\Z|\Z")
"""Cells of a line that separates the header, as in tables of a wiki."""
_DECIMAL_COMMA = re.compile(r"[+-]?\d+,\d+([eE][+-]?\d+)?\Z")
_DECIMAL_POINT = re.compile(r"[+-]?\d+\.\d*([eE][+-]?\d+)?\Z")


def read_sheet(
    path: str | Path, name: str | None = None, names: Sequence[str] = (), table: int | None = None
) -> Sheet:
    """The table of a foreign file.

    Args:
        path: A workbook (xlsx, xls, ods ...) or text with commas, semicolons, tabs or blanks;
            decimal commas are read where every number of the file has them.
        name: Sheet of a workbook; None takes the first that has a table.
        names: Names of the columns of a table without a header.
        table: Number of the table in `read_tables`; None takes the one with most numbers of the
            first sheet, the first of equal ones.

    Raises:
        BadFile: No table of numbers, no such sheet or table, or mixed decimal marks.
    """
    tables = read_tables(path, name, names)
    if table is None:
        return max((t for t in tables if t.sheet == tables[0].sheet), key=lambda t: t.count)
    if not 1 <= table <= len(tables):
        raise BadFile(path, "--table", str(table), f"1 to {len(tables)}: {listed_tables(tables)}")
    return tables[table - 1]


def read_tables(
    path: str | Path, name: str | None = None, names: Sequence[str] = ()
) -> tuple[Sheet, ...]:
    """Every table of a foreign file, numbered in its order; raises BadFile as `read_sheet`."""
    path = Path(path)
    if path.suffix.lower() in WORKBOOKS:
        found = _workbook(path, name, names)
    else:
        found = _tables(path, _text_rows(path), names)
    if not found:
        where = f"sheet {name}" if name else "file"
        raise BadFile(path, where, "no table of numbers", "a header and rows of numbers below it")
    return tuple(replace(sheet, number=i, used=set()) for i, sheet in enumerate(found, 1))


def listed_tables(tables: Sequence[Sheet]) -> str:
    """Tables with number, place, size and columns: `1 (line 6, 11 rows): Target [mm], 1 up ...`."""
    return "; ".join(
        f"{t.number} ({f'sheet {t.sheet}, ' if t.sheet else ''}line {t.lines[0]}, {len(t)} rows): "
        f"{', '.join(filter(None, t.columns[:MAX_LISTED_NAMES]))}"
        f"{' ...' if len(t.columns) > MAX_LISTED_NAMES else ''}"
        for t in tables[:MAX_LISTED_TABLES]
    ) + (f"; and {len(tables) - MAX_LISTED_TABLES} more" * (len(tables) > MAX_LISTED_TABLES))


def most_read(tables: Sequence[Sheet], readings: Callable[[Sheet], int], axis: str = "") -> Sheet:
    """The table that gives a reader most readings; the fullest where it can read none.

    Args:
        readings: Their number; raises DesignError where the table is of another kind.
        axis: Letter that the words above a table may name: such tables come first, those of other
            axes last.
    """

    def rank(sheet: Sheet) -> tuple[bool, int, int, int]:
        named = axis_in("\n".join(sheet.title)) if axis else ""
        try:
            count = readings(sheet)
        except DesignError:
            count = -1
        finally:
            sheet.used.clear()
        return count >= 0, (named == axis) - (named not in ("", axis)), count, sheet.count

    # the only one is not read twice
    return tables[0] if len(tables) == 1 else max(tables, key=rank)


def _workbook(path: Path, name: str | None, names: Sequence[str]) -> list[Sheet]:
    """The tables of one sheet of a workbook, or of all."""
    from python_calamine import CalamineError, CalamineWorkbook

    try:
        book = CalamineWorkbook.from_path(path)
    except (OSError, CalamineError) as error:
        raise BadFile(path, "file", str(error), "a workbook that can be read") from error
    sheets = book.sheet_names
    if name is not None and name not in sheets:
        raise BadFile(path, "sheet", repr(name), f"one of {', '.join(sheets)}")
    out: list[Sheet] = []
    for one in [name] if name else sheets:
        found = book.get_sheet_by_name(one).to_python(skip_empty_area=False)
        rows = [(i + 1, [_cell(c) for c in row]) for i, row in enumerate(found)]
        try:
            out += [replace(sheet, sheet=one) for sheet in _tables(path, rows, names)]
        except BadFile:
            if not out:  # sheets behind one that was read may hold anything
                raise
    return out


def _cell(value: object) -> str | float:
    """A cell of a workbook: numbers as they are, everything else as text."""
    if isinstance(value, bool) or not isinstance(value, int | float):
        return str(value).strip()
    return float(value)


def _text_rows(path: Path) -> list[tuple[int, list[str | float]]]:
    """Rows of a text file, its numbers read."""
    text = read_any_text(path)
    if text.lstrip().startswith("<?xml"):
        kind = "QIF" if "<QIFDocument" in text[:4000] else "XML"
        raise BadFile(path, "file", kind, "a table, text or workbook: export the points as such")
    counts = {s: _typical(text, s) for s in _SEPARATORS}
    separator = next((s for s in _SEPARATORS if counts[s] >= 1), "")
    rows = by_heights(path, text) or by_channels(text)
    if not rows and separator in ("", ","):
        rows = by_blanks(text)
    if not rows:
        reader = csv.reader(io.StringIO(text), delimiter=separator or ",")
        rows = [(reader.line_num, [c.strip() for c in row]) for row in reader]
    rows = [(line, [row[0].lstrip("# "), *row[1:]] if row else row) for line, row in rows]
    rows = [(line, row) for line, row in rows if not all(_RULE.match(c) for c in row)]
    mark = _decimal_mark(path, rows)
    return [(line, [_number(c, mark) for c in row]) for line, row in rows]


def _typical(text: str, separator: str) -> float:
    """Separators in the typical line of the fuller half of a text."""
    counts = sorted(line.count(separator) for line in text.splitlines() if line.strip())
    return float(np.median(counts[len(counts) // 2 :])) if counts else 0.0


def _decimal_mark(path: Path, rows: Sequence[tuple[int, list[str]]]) -> str:
    """The decimal mark that all numbers of a file share; raises BadFile where both stand."""
    commas = [line for line, row in rows if any(_DECIMAL_COMMA.match(c) for c in row)]
    points = [line for line, row in rows if any(_DECIMAL_POINT.match(c) for c in row)]
    if commas and points:
        found = f"decimal commas, and decimal points in line {points[0]}"
        raise BadFile(path, commas[0], found, "one decimal mark in the whole file")
    return "," if commas else "."


def _number(cell: str, mark: str) -> str | float:
    """A cell as a number if it is one."""
    if "_" in cell or not cell.isascii():
        return cell
    try:
        return float(cell.replace(mark, "."))
    except ValueError:
        return cell


def _tables(path: Path, rows: Sequence[Row], names: Sequence[str]) -> list[Sheet]:
    """Tables of some rows; a fault of the fullest one is raised."""
    rows = [(line, row) for line, row in rows if any(c != "" for c in row)]
    parts = separate_tables(rows, _is_data)
    numbers = [sum(isinstance(c, float) for _, row in p.rows for c in row) for p in parts]
    out = []
    for i, part in enumerate(parts):
        try:
            sheet = _table(path, part.rows, names, part.passed_over)
        except BadFile:
            if numbers[i] == max(numbers):
                raise
            continue
        out += [] if sheet is None else [sheet]
    return out


def _table(
    path: Path, rows: Sequence[Row], names: Sequence[str], passed_over: Sequence[int]
) -> Sheet | None:
    """Header and rows of numbers, None where there are none."""
    first = next((i for i in range(len(rows)) if _begins_table(rows, i)), None)
    if first is None:
        return None
    above = [i for i in range(first) if sum(c != "" for c in rows[i][1]) >= 2]
    width = max(len(row) for _, row in rows[first:])
    rows = [(line, [*row, *[""] * (width - len(row))]) for line, row in rows]
    if not above and not names and isinstance(rows[first][1][0], str):
        names = [f"column {i + 1}" for i in range(width)]  # rows have names, as columns have else
    if not above and not names:
        raise BadFile(path, rows[first][0], "numbers", "a line of column names above, or --columns")
    if names and len(names) != width:
        raise BadFile(path, "table", f"{width} columns", f"{len(names)}, as --columns names them")
    header = tuple(names) or _header([rows[i][1][:width] for i in above[-3:]])
    begin = first if names else above[-1] + 1
    data, others = _data_rows(rows[begin:])
    blocks = _blocks(rows, {line for line, _ in data})
    out_of = set(others)
    return Sheet(
        path=path,
        columns=header,
        cells=tuple(tuple(row) for _, row in data),
        lines=tuple(line for line, _ in data),
        title=tuple(_words(row) for _, row in rows[: max(begin - 1, 0)]),
        left_out=tuple(sorted([*others, *passed_over])),
        above=tuple(blocks[line] for line, _ in data),
        of_words=tuple((line, tuple(row)) for line, row in rows[begin:] if line in out_of),
    )


def _words(row: Sequence[str | float]) -> str:
    """Cells of a row as a text."""
    return " ".join(str(c) for c in row if c != "")


def _blocks(rows: Sequence[Row], data: set[int]) -> dict[int, str]:
    """What stands above the block of each row of numbers, by its line."""
    out: dict[int, str] = {}
    words: list[str] = []
    block = ""
    for line, row in rows:
        if line in data:
            block, words = "\n".join(words) if words else block, []
            out[line] = block
        else:
            words.append(_words(row))
    return out


def _data_rows(rows: Sequence[Row]) -> tuple[list[Row], list[int]]:
    """Rows of numbers with their lines, and the lines of all others.

    A word alone in a line names the rows below it that have no word of their own in its column.
    """
    data: list[Row] = []
    others: list[int] = []
    heading: tuple[int, str] | None = None
    for line, row in rows:
        filled = [(i, c) for i, c in enumerate(row) if c != ""]
        if _is_data(row):
            cells = list(row)
            if heading is not None and cells[heading[0]] == "":
                cells[heading[0]] = heading[1]
            data.append((line, cells))
        elif len(filled) == 1 and isinstance(filled[0][1], str):
            heading = (filled[0][0], filled[0][1])
        else:
            others.append(line)
    footers = _footers(data)
    return [pair for pair in data if pair[0] not in footers], sorted([*others, *footers])


def _footers(data: Sequence[Row]) -> set[int]:
    """Lines of means and limits, which have a word in the first column of numbers."""
    for cells in zip(*(row for _, row in data), strict=True):
        if sum(isinstance(c, float) for c in cells) > MIN_NUMBER_SHARE * len(cells):
            lines = (line for line, _ in data)
            return {n for n, c in zip(lines, cells, strict=True) if isinstance(c, str) and c}
    return set()


def _begins_table(rows: Sequence[Row], i: int) -> bool:
    """Whether a row of numbers begins the table: numbers of cycles stand above a row of names."""
    if not _is_data(rows[i][1]):
        return False
    after = rows[i + 1][1] if i + 1 < len(rows) else ()
    words = sum(isinstance(c, str) and c != "" for c in after)
    more = any(_is_data(row) for _, row in rows[i + 2 :])
    return not (words >= 2 and not _is_data(after) and more)


def _is_data(row: Sequence[str | float]) -> bool:
    """Whether at least two cells and half of them are numbers."""
    filled = [c for c in row if c != ""]
    numbers = sum(isinstance(c, float) for c in filled)
    return numbers >= 2 and 2 * numbers >= len(filled)


def _header(rows: Sequence[Sequence[str | float]]) -> tuple[str, ...]:
    """Names of the columns: the last row of names, with the rows above where names stand twice.

    A cell in an upper row counts for the columns up to the next, as in merged cells. A row of units
    alone is put behind the names above it.
    """
    names = [[f"{c:g}" if isinstance(c, float) else c for c in row] for row in rows]
    last = names.pop()
    if names and all(is_unit(n) for n in last if n):
        pairs = zip(names.pop(), last, strict=True)
        last = [f"{name} [{unit.strip('[]() ')}]" if unit else name for name, unit in pairs]
    filled = [n for n in last if n]
    if not names or len(set(filled)) == len(filled):
        return tuple(last)
    carried, upper = "", []
    for name in names[-1]:
        carried = name or carried
        upper.append(carried)
    return tuple(f"{a} {b}".strip() for a, b in zip(upper, last, strict=True))


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
