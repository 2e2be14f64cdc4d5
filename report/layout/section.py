"""What a page consists of: sections, each with its sentences, its table and its pictures.

A section is a record without HTML; `page.html` renders all of them in one way. Texts know four
marks: `code` between backquotes, **bold**, the index of u_{cal}, and [words](address).
"""

from collections.abc import Callable, Collection, Iterable, Mapping, Sequence
from dataclasses import dataclass
from typing import TypeVar

from markupsafe import Markup

from matstd.report.style import Figure

T = TypeVar("T")

Heading = str | tuple[str, str]  # of a column; a pair is a group of columns and the one in it


@dataclass(frozen=True, slots=True, eq=False)
class Picture:
    """A PNG of a page."""

    file: str  # path as seen from the page
    caption: str  # what it shows; its first sentence is the alternative text
    # saved to the file with the page; None for a file that exists already
    figure: Figure | None = None


@dataclass(frozen=True, slots=True)
class Table:
    """Rows of text. Cells that begin with a number are aligned as numbers."""

    columns: Sequence[Heading]  # headings; without any, the first cell of each row is its heading
    rows: Sequence[Sequence[str]]  # cells; a line break in a cell is one on the page
    caption: str = ""  # above the table
    best: Collection[int] = ()  # indices of rows in bold
    is_file: bool = False  # whether the page has a link to its file in place of its rows

    @classmethod
    def of(
        cls,
        items: Iterable[T],
        cells: Mapping[str, Callable[[T], str]],
        caption: str = "",
        is_best: Callable[[T], bool] = lambda _: False,
    ) -> "Table":
        """A row for each item; every heading with the function that makes its cell."""
        every = list(items)
        rows = [[cell(item) for cell in cells.values()] for item in every]
        best = [i for i, item in enumerate(every) if is_best(item)]
        return cls(tuple(cells), rows, caption, best)


@dataclass(frozen=True, slots=True)
class Section:
    """One subject, shown in the order of the attributes."""

    title: str = ""  # empty to continue the section above
    fold: str = ""  # summary under which everything below the title is folded away; empty for open
    sentences: Sequence[str] = ()  # paragraphs
    items: Sequence[str] = ()  # points of a list
    is_ordered: bool = False  # whether these are steps, in their order
    # at most one; a further one goes into a section that continues this one
    table: Table | None = None
    pictures: Sequence[Picture] = ()  # below the table
    code: str = ""  # shown as it is
    notes: Sequence[str] = ()  # set apart from the text
    warnings: Sequence[str] = ()  # like notes, for what can cause damage or a wrong result
    is_part: bool = False  # whether the title is one of a subsection
    is_unfolded: bool = False  # whether a fold is open at first
    is_for_screen: bool = False  # whether a fold is left out of print


@dataclass(frozen=True, slots=True)
class KeyFigure:
    """One of the figures at the head of a page."""

    value: str  # with its unit
    words: str  # what it is
    look: str = ""  # `good`, `fair`, `found` or `bad`; empty for neither


@dataclass(frozen=True, slots=True)
class LiveView:
    """What moves on a page, where its reader's browser runs scripts; HTML as it stands."""

    style: Markup  # style sheet, in the head
    place: Markup  # element that the script fills, below the head of the page; hidden until then
    script: Markup  # data and script, behind everything else


@dataclass(frozen=True, slots=True)
class Page:
    """A whole page."""

    heading: str  # of the page and its window
    lead: str  # the result in a sentence or two
    key: Sequence[KeyFigure]  # its figures
    sections: Sequence[Section]  # those before the first title stand above the table of contents
    foot: Sequence[str] = ()  # what the figures rest upon
    # what the result means for the user, in a box below the lead; empty for nothing
    means: str = ""
    next: str = ""  # what to do now, in the same box; empty for nothing
    # what moves, above the sections, which are then folded; None for a page of pictures
    live: LiveView | None = None
