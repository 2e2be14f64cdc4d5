"""The tables of a page as CSV files and as a workbook, beside it, in the units of the page."""

import re
from pathlib import Path

from matstd.report.layout.section import Page, Table
from matstd.twin.files import write_whole, written_whole
from matstd.twin.text import csv_text
from matstd.twin.words import in_own_unit

FOLDER, WORKBOOK = "tables", "tables.xlsx"  # where they go, beside the page
_LONGEST = 31  # letters of a sheet's name, by the format
_WIDEST = 60  # letters of a column before its text is cut off on the screen
_NUMBER = re.compile(r"[+\-−]?(\d+|\d{1,3}( \d{3})+)(\.\d+)?([eE][+\-]?\d+)?")
_MINUS = re.compile(r"−(?=\d)")
_MARKS = re.compile(r"`|\*\*|_\{(\w+)\}|\[([^\]]+)\]\([\w./#-]+\)")


def file_names(page: Page) -> dict[int, str]:
    """Files of the tables of a page, as the page names them, by the identity of the table."""
    return {id(table): f"{FOLDER}/{name}.csv" for name, _, table in page_tables(page)}


def page_tables(page: Page) -> list[tuple[str, str, Table]]:
    """Tables of a page that have rows: name of the file, the title above, and the table."""
    found: list[tuple[str, str, Table]] = []
    title = ""
    for section in page.sections:
        title = section.title or title
        if section.table is not None and section.table.rows:
            slug = re.sub(r"[^a-z0-9]+", "-", unmarked(title).lower()).strip("-") or "table"
            found.append((f"{len(found) + 1:02d}-{slug}", title, section.table))
    return found


def write_tables(folder: Path, page: Page) -> list[Path]:
    """Write every table of a page as CSV into `tables/`, and all of them into one workbook."""
    from openpyxl import Workbook
    from openpyxl.styles import Font
    from openpyxl.utils import get_column_letter

    book, out = Workbook(), []
    del book["Sheet"]
    for name, _, table in page_tables(page):
        headings, rows = _headings(table), [[plain(c) for c in row] for row in table.rows]
        out.append(folder / FOLDER / f"{name}.csv")
        head, *others = [*headings, *rows]
        write_whole(out[-1], csv_text(head, others))
        sheet = book.create_sheet(name[:_LONGEST])
        sheet.append([plain(table.caption)])
        for row in headings:
            sheet.append(row)
            for cell in sheet[sheet.max_row]:
                cell.font = Font(bold=True)
        for row in rows:
            sheet.append([value(cell) for cell in row])
        for k, column in enumerate(zip(*headings, *rows, strict=True), start=1):
            width = min(max(map(len, column)) + 2, _WIDEST)
            sheet.column_dimensions[get_column_letter(k)].width = width
    if out:
        out.append(folder / WORKBOOK)
        with written_whole(out[-1]) as part:
            book.save(part)
    return out


def _headings(table: Table) -> list[list[str]]:
    """One row of headings, or two where columns form groups."""
    pairs = [c if isinstance(c, tuple) else (c, c) for c in table.columns]
    rows = [[plain(pair[k]) for pair in pairs] for k in (0, 1)]
    return [row for k, row in enumerate(rows) if row and (not k or row != rows[0])]


def unmarked(words: str) -> str:
    """Words of a page without their marks, on one line, in the unit of the instrument."""
    plain_words = _MARKS.sub(lambda m: m[1] or m[2] or "", words)
    return in_own_unit(" ".join(plain_words.split()))


def plain(cell: str) -> str:
    """A cell with numbers as programs read them: a hyphen for a minus, no spaces in a number.

    Example:
        >>> plain("−21, 62"), plain("13 000"), plain("3 of 400")
        ('-21, 62', '13000', '3 of 400')
    """
    cell = _MINUS.sub("-", unmarked(cell))
    return cell.replace(" ", "") if _NUMBER.fullmatch(cell) else cell


def value(cell: str) -> float | str:
    """A cell as a number where it is nothing but one.

    Example:
        >>> value("-12.5"), value("3 of 4"), value("FFS1")
        (-12.5, '3 of 4', 'FFS1')
    """
    return float(cell) if _NUMBER.fullmatch(cell) else cell
