"""Pages as HTML: one self-contained file each, which loads nothing from anywhere."""

import base64
import io
import re
from collections.abc import Sequence
from itertools import groupby
from pathlib import Path

from jinja2 import Environment, PackageLoader, StrictUndefined, select_autoescape
from markupsafe import Markup, escape

from matstd.report.layout.section import Heading, Page, Section, Table
from matstd.report.layout.tables import file_names, unmarked, write_tables
from matstd.report.numbers import unbroken
from matstd.report.style import save
from matstd.twin.files import write_whole
from matstd.twin.versions import versions
from matstd.twin.words import in_own_unit

MIN_SECTIONS = 3  # sections from which a page has a table of contents

_MARKS = (
    (re.compile(r"\*\*(.+?)\*\*"), r"<b>\1</b>"),
    (re.compile(r"_\{(\w+)\}"), r"<sub>\1</sub>"),
    (re.compile(r"\[([^\]]+)\]\(([\w./#-]+)\)"), r'<a href="\2">\1</a>'),
    (re.compile(r"\n"), "<br>"),
)
_NEARLY_WHITE = 248  # of 255
PROSE = 60  # characters from which a cell that begins with a number is a sentence, which is wrapped

_NUMBER = re.compile(r"[<±+\-−]?\s?\d")


def write_page(path: Path, page: Page) -> Path:
    """Save the pictures of a page, render it into one file, and write its tables beside it.

    The page is written whole or not at all. Returns its path.
    """
    folder = path.parent
    for picture in (p for section in page.sections for p in section.pictures):
        if picture.figure is not None:
            (folder / picture.file).parent.mkdir(parents=True, exist_ok=True)
            save(picture.figure, folder / picture.file)
    write_whole(path, in_own_unit(rendered(page, folder)))
    write_tables(folder, page)
    return path


def rendered(page: Page, folder: Path) -> str:
    """The HTML of a page whose pictures lie in a folder."""
    environment = Environment(
        loader=PackageLoader("matstd.report.layout"),
        autoescape=select_autoescape(["html"]),
        undefined=StrictUndefined,
        trim_blocks=True,
        lstrip_blocks=True,
    )
    files = file_names(page)
    environment.filters |= {
        "marked": marked,
        "unmarked": unmarked,
        "is_number": lambda cell: len(cell) < PROSE and bool(_NUMBER.match(cell)),
        "heading_rows": heading_rows,
        "numeric": numeric,
        "table_file": lambda table: files[id(table)],
        "picture": lambda file: picture(folder / file, is_small=page.live is not None),
    }
    sections = with_addresses(page.sections)
    contents = [(address, section.title) for section, address in sections if address]
    template = environment.get_template("page.html")
    return template.render(
        page=page,
        sections=sections,
        contents=contents if len(contents) >= MIN_SECTIONS else (),
        versions=versions(),
    )


def with_addresses(sections: Sequence[Section]) -> list[tuple[Section, str]]:
    """Sections with the address to which the contents lead; empty below a section's title."""
    titled = [s for s in sections if s.title and not s.is_part]
    slugs = [re.sub(r"[^a-z0-9]+", "-", s.title.lower()).strip("-") for s in titled]
    if len(set(slugs)) < len(slugs):
        slugs = [f"{slug}-{k}" for k, slug in enumerate(slugs)]
    address = {id(section): slug for section, slug in zip(titled, slugs, strict=True)}
    return [(section, address.get(id(section), "")) for section in sections]


def marked(words: str) -> Markup:
    """Words with their marks as HTML.

    Example:
        >>> print(marked("`a-1` < **b**"))
        <code>a-1</code> &lt; <b>b</b>
    """
    out = []
    for k, part in enumerate(words.split("`")):
        html = str(escape(part))
        if k % 2:
            out.append(f"<code>{html}</code>")
            continue
        html = unbroken(html)
        for pattern, by in _MARKS:
            html = pattern.sub(by, html)
        out.append(html)
    return Markup("".join(out))  # escaped above


def numeric(table: Table) -> list[bool]:
    """Columns in which numbers are the rule."""
    columns = ([cell for cell in column if cell] for column in zip(*table.rows, strict=True))
    return [2 * sum(bool(_NUMBER.match(c)) for c in cells) > len(cells) for cells in columns]


def heading_rows(columns: Sequence[Heading]) -> list[list[tuple[str, int, int, int]]]:
    """Rows of headings: words, index of the column, columns and rows that each cell spans."""
    is_grouped = any(isinstance(c, tuple) for c in columns)
    first: list[tuple[str, int, int, int]] = []
    second: list[tuple[str, int, int, int]] = []
    for group, members in groupby(enumerate(columns), key=_group):
        cells = list(members)
        if isinstance(cells[0][1], tuple):
            first.append((group, cells[0][0], len(cells), 1))
            second += [(column[1], k, 1, 1) for k, column in cells]
        else:
            first += [(str(column), k, 1, 1 + is_grouped) for k, column in cells]
    return [first, second] if is_grouped else [first]


def _group(cell: tuple[int, Heading]) -> str:
    return cell[1][0] if isinstance(cell[1], tuple) else f"column {cell[0]}"


def picture(path: str | Path, is_small: bool = False) -> str:
    """A PNG or SVG file as a data address, so that the page stands alone.

    Args:
        is_small: Whether a PNG keeps 256 colours: charts look the same at a third of the size.
    """
    path = Path(path)
    kind = {".png": "image/png", ".svg": "image/svg+xml"}[path.suffix]
    data = path.read_bytes()
    if is_small and path.suffix == ".png":
        data = _in_few_colours(data)
    return f"data:{kind};base64,{base64.b64encode(data).decode('ascii')}"


def _in_few_colours(data: bytes) -> bytes:
    """A PNG with a palette; white stays white."""
    from PIL import Image

    drawn = Image.open(io.BytesIO(data)).convert("RGB")
    few = drawn.quantize(256, method=Image.Quantize.FASTOCTREE, dither=Image.Dither.NONE)
    palette = few.getpalette() or []
    few.putpalette([255 if v > _NEARLY_WHITE else v for v in palette])
    out = io.BytesIO()
    few.save(out, format="PNG", optimize=True)
    return min(out.getvalue(), data, key=len)
