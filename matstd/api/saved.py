"""Results that leave files and a page in a folder."""

from abc import ABC, abstractmethod
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from dataclasses import fields
from pathlib import Path
from typing import TYPE_CHECKING, Any, ClassVar, TypeVar

import numpy as np

from matstd.diagnosis.files import law_table, visit_text
from matstd.diagnosis.fit import Fit
from matstd.diagnosis.geometry import found_arm
from matstd.diagnosis.laws import Learning, SecondRun
from matstd.diagnosis.next_visit import VisitPlan, plan_visit
from matstd.importers import machine_text
from matstd.options import asked_printer, print_report
from matstd.report.laws import effect_text
from matstd.report.numbers import microns
from matstd.twin.files import results_folder, write_whole
from matstd.twin.files.whole import write_json

if TYPE_CHECKING:
    from _typeshed import DataclassInstance

T = TypeVar("T")

REPORT_FILES = ("report.html", "report.pdf", "tables.xlsx", "tables/*.csv")
"""Files of a page that not every run of a command leaves."""

EFFECT, LAW, VISIT = "effect.py", "law.json", "next_visit.csv"
"""Files of a law that was learnt: as an effect of the user's own, for other programs, and the
touches that distinguish it from its rivals."""

FOUND = "machine_found.toml"  # machine file of a serial arm with the lines of all joints as found


def extended(kind: type[T], record: "DataclassInstance", **more: Any) -> T:
    """A record of a room below as the door returns it, with what is known here besides."""
    known = {f.name: getattr(record, f.name) for f in fields(record)}
    return kind(**known, **more)


@contextmanager
def page_folder(
    folder: str | Path, pdf: bool, force: bool, sometimes: Sequence[str]
) -> Iterator[Path]:
    """A folder of results that appears whole or not at all, its page printed where that is asked.

    Args:
        sometimes: Files that not every such result leaves.
    """
    printed_by = asked_printer(pdf)
    with results_folder(folder, force, sometimes) as place:
        yield place
        print_report(place, printed_by)


class Saveable(ABC):
    """A result that writes its files and its page into a folder, whole or not at all."""

    sometimes: ClassVar[tuple[str, ...]]  # files that not every such result leaves

    def save(self, folder: str | Path, pdf: bool = False, force: bool = False) -> Path:
        """Write results and page into a folder, whole or not at all.

        Args:
            folder: New or empty.
            pdf: Print the page into report.pdf, too.
            force: Replace the results of an earlier run.
        """
        with page_folder(folder, pdf, force, self.sometimes) as place:
            self.write(place)
            self.write_page(place)
        return Path(folder)

    def page(self, folder: str | Path, pdf: bool = False, force: bool = False) -> Path:
        """Write report.html with its pictures and tables into a folder; arguments as of `save`."""
        with page_folder(folder, pdf, force, self.sometimes) as place:
            self.write_page(place)
        return Path(folder) / "report.html"

    @abstractmethod
    def write(self, folder: Path) -> str:
        """Write the results, without a page, into an existing folder.

        Returns:
            A line on the machine of a serial arm as it was found; "" for any other machine.
        """

    @abstractmethod
    def write_page(self, folder: Path) -> None:
        """Write the page into an existing folder."""


def write_found_arm(folder: Path, fit: Fit, title: str) -> str:
    """Write the machine file of a serial arm as a run found it, if the machine is one.

    Returns:
        What the file is good for; "" where nothing was written.
    """
    arm = found_arm(fit)
    if arm is None:
        return ""
    write_whole(folder / FOUND, machine_text(arm.chain, title, is_known=True))
    return (
        f"{FOUND} has the lines of all joints as found, to put in the machine file's place: with "
        f"nothing but the set-up {microns(arm.after)} are left then, {microns(arm.before)} now; "
        "take all of them or none, and import again, which finds the reflector anew"
    )


def next_visit(laws: Learning) -> VisitPlan:
    """The visit that distinguishes laws from their rivals; the same plan every time."""
    return plan_visit(laws, np.random.default_rng(0))


def write_learnt(
    folder: Path, laws: Learning, title: str, visit: VisitPlan, second: SecondRun | None = None
) -> None:
    """Write law.json and, with a law, effect.py; next_visit.csv where touches are planned."""
    write_json(folder / LAW, law_table(laws, title, visit, second))
    if laws.laws:
        write_whole(folder / EFFECT, effect_text(laws, title))
    if text := visit_text(visit):
        write_whole(folder / VISIT, text)
