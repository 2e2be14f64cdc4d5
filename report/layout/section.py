"""What a page consists of: sections, each with its sentences, its table and its pictures.

A section is a record without HTML; `page.html` renders all of them in one way. Texts know four
marks: `code` between backquotes, **bold**, the index of u_{cal}, and [words](address).
"""

from __future__ import annotations

from collections.abc import Callable, Collection, Iterable, Mapping, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, TypeVar

if TYPE_CHECKING:
    from markupsafe import Markup
    from matplotlib.figure import Figure

T = TypeVar("T")

Heading = str | tuple[str, str]
"""Of a column; a pair is a group of columns and the one in it."""


@dataclass(frozen=True, slots=True, eq=False)
class Picture:
    """A PNG of a page.

    Attributes:
        file: Path as seen from the page.
        caption: What it shows; its first sentence is the alternative text.
        figure: Saved to the file with the page; None for a file that exists already.
    """

    file: str
    caption: str
    figure: Figure | None = None


@dataclass(frozen=True, slots=True)
class Table:
    """Rows of text. Cells that begin with a number are aligned as numbers.

    Attributes:
        columns: Headings; without any, the first cell of each row is its heading.
        rows: Cells; a line break in a cell is one on the page.
        caption: Above the table.
        best: Indices of rows in bold.
        is_file: Whether the page has a link to its file in the place of its rows.
    """

    columns: Sequence[Heading]
    rows: Sequence[Sequence[str]]
    caption: str = ""
    best: Collection[int] = ()
    is_file: bool = False

    @classmethod
    def of(
        cls,
        items: Iterable[T],
        cells: Mapping[str, Callable[[T], str]],
        caption: str = "",
        is_best: Callable[[T], bool] = lambda _: False,
    ) -> Table:
        """A row for each item; every heading with the function that makes its cell."""
        every = list(items)
        rows = [[cell(item) for cell in cells.values()] for item in every]
        best = [i for i, item in enumerate(every) if is_best(item)]
        return cls(tuple(cells), rows, caption, best)


@dataclass(frozen=True, slots=True)
class Section:
    """One subject, shown in the order of the attributes.

    Attributes:
        title: Empty to continue the section above.
        fold: Summary under which everything below the title is folded away; empty for open.
        sentences: Paragraphs.
        items: Points of a list.
        is_ordered: Whether these are steps, in their order.
        table: At most one; a further one goes into a section that continues this one.
        pictures: Below the table.
        code: Shown as it is.
        notes: Set apart from the text.
        warnings: Like notes, for what can cause damage or a wrong result.
        is_part: Whether the title is one of a subsection.
        is_unfolded: Whether a fold is open at first.
        is_for_screen: Whether a fold is left out of print.
    """

    title: str = ""
    fold: str = ""
    sentences: Sequence[str] = ()
    items: Sequence[str] = ()
    is_ordered: bool = False
    table: Table | None = None
    pictures: Sequence[Picture] = ()
    code: str = ""
    notes: Sequence[str] = ()
    warnings: Sequence[str] = ()
    is_part: bool = False
    is_unfolded: bool = False
    is_for_screen: bool = False


@dataclass(frozen=True, slots=True)
class KeyFigure:
    """One of the figures at the head of a page.

    Attributes:
        value: With its unit.
        words: What it is.
        look: `good`, `fair`, `found` or `bad`; empty for neither.
    """

    value: str
    words: str
    look: str = ""


@dataclass(frozen=True, slots=True)
class LiveView:
    """What moves on a page, where its reader's browser runs scripts; HTML as it stands.

    Attributes:
        style: Style sheet, in the head.
        place: Element that the script fills, below the head of the page; hidden until then.
        script: Data and script, behind everything else.
    """

    style: Markup
    place: Markup
    script: Markup


@dataclass(frozen=True, slots=True)
class Page:
    """A whole page.

    Attributes:
        title: Of the window.
        heading: Of the page.
        lead: The result in a sentence or two.
        key: Its figures.
        sections: Those before the first title stand above the table of contents.
        foot: What the figures rest upon.
        means: What the result means for the user, in a box below the lead; empty for nothing.
        next: What to do now, in the same box; empty for nothing.
        live: What moves, above the sections, which are then folded; None for a page of pictures.
    """

    title: str
    heading: str
    lead: str
    key: Sequence[KeyFigure]
    sections: Sequence[Section]
    foot: Sequence[str] = ()
    means: str = ""
    next: str = ""
    live: LiveView | None = None
