"""Results that leave files and a page in a folder."""

from abc import ABC, abstractmethod
from pathlib import Path
from typing import ClassVar

from matstd.report.pages import Printer, printer
from matstd.twin.files import results_folder

REPORT_FILES = ("report.html", "report.pdf", "tables.xlsx", "tables/*.csv")
"""Files of a page that not every run of a command leaves."""


class Saveable(ABC):
    """A result that writes its files and its page into a folder, whole or not at all.

    Attributes:
        sometimes: Files that not every such result leaves.
    """

    sometimes: ClassVar[tuple[str, ...]]

    def save(self, folder: str | Path, pdf: bool = False, force: bool = False) -> Path:
        """Write results and page into a folder, whole or not at all.

        Args:
            folder: New or empty.
            pdf: Print the page into report.pdf, too.
            force: Replace the results of an earlier run.
        """
        printed_by = printer() if pdf else None
        with results_folder(folder, force, self.sometimes) as place:
            self.write(place)
            self.write_page(place, printed_by)
        return Path(folder)

    def page(self, folder: str | Path, pdf: bool = False, force: bool = False) -> Path:
        """Write report.html with its pictures and tables into a folder; arguments as of `save`."""
        printed_by = printer() if pdf else None
        with results_folder(folder, force, self.sometimes) as place:
            self.write_page(place, printed_by)
        return Path(folder) / "report.html"

    @abstractmethod
    def write(self, folder: Path) -> str:
        """Write the results, without a page, into an existing folder.

        Returns:
            A line on the machine of a serial arm as it was found; "" for any other machine.
        """

    @abstractmethod
    def write_page(self, folder: Path, printed_by: Printer | None = None) -> None:
        """Write the page into an existing folder."""
