"""The live view in a notebook: a page inside a frame, which loads nothing."""

from html import escape
from pathlib import Path
from tempfile import TemporaryDirectory

from matstd.report.layout import LiveView, Page, write_page
from matstd.twin.files import write_whole

HEIGHT = 760  # of the frame, pixels


class Framed:
    """A live view that a notebook shows; `save` writes it as a page of its own.

    Attributes:
        page: The HTML.
    """

    def __init__(self, title: str, lead: str, view: LiveView) -> None:
        """Make the page of a view; arguments as of `Page`."""
        page = Page(title=title, heading=title, lead=lead, key=(), sections=(), live=view)
        with TemporaryDirectory() as folder:
            path = Path(folder) / "view.html"
            write_page(path, page)
            self.page = path.read_text(encoding="utf-8")

    def _repr_html_(self) -> str:
        """The page in a frame of its own, so that neither disturbs the other."""
        style = f"width:100%;height:{HEIGHT}px;border:0"
        return f'<iframe srcdoc="{escape(self.page)}" style="{style}"></iframe>'

    def save(self, path: str | Path) -> Path:
        """Write the page."""
        write_whole(path, self.page)
        return Path(path)
