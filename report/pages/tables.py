"""The tables of a page as CSV files and as a workbook, beside it.

They are read from the finished page, so that they say what it says, in the units of its headings.
"""

import re
from dataclasses import dataclass, field
from html.parser import HTMLParser
from pathlib import Path

from matstd.twin.files import write_whole, written_whole
from matstd.twin.text import csv_text

FOLDER, WORKBOOK = "tables", "tables.xlsx"
"""Where they go, beside the page."""

_LONGEST = 31  # letters of a sheet's name, by the format
_WIDEST = 60  # letters of a column before its text is cut off on the screen
_NUMBER = re.compile(r"[+\-−]?(\d+|\d{1,3}( \d{3})+)(\.\d+)?([eE][+\-]?\d+)?")
_MINUS = re.compile(r"−(?=\d)")


@dataclass(slots=True)
class PageTable:
    """One table of a page.

    Attributes:
        section: Heading above it.
        caption: Its caption, "" where it has none.
        rows: Cells as the page shows them, headings first.
        headings: Number of rows that are headings.
    """

    section: str
    caption: str = ""
    rows: list[list[str]] = field(default_factory=list)
    headings: int = 0


def page_tables(page: str) -> list[PageTable]:
    """Tables of a page in their order; cells that span several are repeated in each."""
    reader = _Reader()
    reader.feed(page)
    return [table for table in reader.tables if len(table.rows) > table.headings]


def write_tables(page: str | Path) -> list[Path]:
    """Write every table of a page as CSV, and all of them into one workbook.

    Args:
        page: HTML file; `tables/` and `tables.xlsx` go into its folder.

    Returns:
        The files.
    """
    from openpyxl import Workbook
    from openpyxl.styles import Font
    from openpyxl.utils import get_column_letter

    page = Path(page)
    book = Workbook()
    del book["Sheet"]
    out = []
    for number, table in enumerate(page_tables(page.read_text(encoding="utf-8")), start=1):
        name = f"{number:02d}-{_slug(table.section)}"
        out.append(page.parent / FOLDER / f"{name}.csv")
        head, *rows = ([plain(cell) for cell in row] for row in table.rows)
        write_whole(out[-1], csv_text(head, rows))
        sheet = book.create_sheet(name[:_LONGEST])
        for row in ([table.caption], *table.rows):
            sheet.append([value(plain(cell)) for cell in row])
        for heading in sheet.iter_rows(min_row=2, max_row=1 + table.headings):
            for cell in heading:
                cell.font = Font(bold=True)
        for k, column in enumerate(zip(*table.rows, strict=True), start=1):
            width = min(max(map(len, column)) + 2, _WIDEST)
            sheet.column_dimensions[get_column_letter(k)].width = width
    if out:
        out.append(page.parent / WORKBOOK)
        with written_whole(out[-1]) as part:
            book.save(part)
    return out


def plain(cell: str) -> str:
    """A cell with numbers as programs read them: a hyphen for a minus, no spaces in a number.

    Example:
        >>> plain("−21, 62"), plain("13 000"), plain("3 of 400")
        ('-21, 62', '13000', '3 of 400')
    """
    cell = _MINUS.sub("-", cell)
    return cell.replace(" ", "") if _NUMBER.fullmatch(cell) else cell


def value(cell: str) -> float | str:
    """A cell as a number where it is nothing but one.

    Example:
        >>> value("-12.5"), value("3 of 4"), value("FFS1")
        (-12.5, '3 of 4', 'FFS1')
    """
    return float(cell) if _NUMBER.fullmatch(cell) else cell


def _slug(text: str) -> str:
    return re.sub(r"[^a-z0-9]+", "-", text.lower()).strip("-") or "table"


class _Reader(HTMLParser):
    """Collects headings, captions and cells."""

    def __init__(self) -> None:
        super().__init__()
        self.tables: list[PageTable] = []
        self._section = ""
        self._text: list[str] | None = None
        self._spans: dict[tuple[int, int], str] = {}
        self._cell = (1, 1)

    def handle_starttag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
        """Begin a table, a row, or a text that is kept."""
        if tag == "table":
            self.tables.append(PageTable(self._section))
            self._spans = {}
        elif tag == "tr":
            self.tables[-1].rows.append([])
            self._is_heading = True
        elif tag in {"h2", "h3", "caption", "th", "td"}:
            self._text = []
            told = {key: int(v or 1) for key, v in attrs if key in {"rowspan", "colspan"}}
            self._cell = told.get("rowspan", 1), told.get("colspan", 1)
            self._is_heading = tag != "td" and getattr(self, "_is_heading", True)
        elif tag == "br" and self._text is not None:
            self._text.append(" ")

    def handle_data(self, data: str) -> None:
        """Text of a heading, a caption or a cell."""
        if self._text is not None:
            self._text.append(data)

    def handle_endtag(self, tag: str) -> None:
        """Keep what has ended."""
        if tag in {"h2", "h3", "caption", "th", "td"} and self._text is not None:
            text, self._text = " ".join("".join(self._text).split()), None
            if tag in {"h2", "h3"}:
                self._section = text
            elif tag == "caption":
                self.tables[-1].caption = text
            else:
                self._keep(text)
        elif tag == "tr":
            self._fill()
            if self._is_heading:
                self.tables[-1].headings += 1
        elif tag == "table":
            _level(self.tables[-1])

    def _keep(self, text: str) -> None:
        """A cell at the next free place of its row, and what it spans below."""
        self._fill()
        row, number = self.tables[-1].rows[-1], len(self.tables[-1].rows) - 1
        down, across = self._cell
        for below in range(1, down):
            for k in range(across):
                self._spans[number + below, len(row) + k] = text
        row.extend([text] * across)

    def _fill(self) -> None:
        """What cells of earlier rows span of this row."""
        row, number = self.tables[-1].rows[-1], len(self.tables[-1].rows) - 1
        while (number, len(row)) in self._spans:
            row.append(self._spans.pop((number, len(row))))


def _level(table: PageTable) -> None:
    """Rows of one length; a row of one heading cell and data is data with a name."""
    longest = max(map(len, table.rows), default=0)
    for row in table.rows:
        row.extend([""] * (longest - len(row)))
