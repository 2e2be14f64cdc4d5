"""Measurements against a model: the result with its files and its page."""

from collections.abc import Mapping
from dataclasses import dataclass, fields
from pathlib import Path

import numpy as np

from matstd.api.arm import FOUND, write_found_arm
from matstd.api.runs import GEOMETRY, Runs, StartingModel, starting_run
from matstd.diagnosis import answer
from matstd.diagnosis.evidence import Progress, quiet
from matstd.diagnosis.files import SavedModel, write_comparison, write_residuals
from matstd.report.pages import Printer, printer, write_compare_page, write_pdf
from matstd.report.words import remark_sentence, structure_words
from matstd.twin.files import results_folder
from matstd.twin.record import without_copies
from matstd.twin.words import deviations_in

REPORT_FILES = ("report.html", "report.pdf", "tables.xlsx", "tables/*.csv")
"""Files of a page that not every run of a command leaves."""

SOMETIMES = (FOUND, "pictures/*.png", *REPORT_FILES)
"""Files that not every comparison leaves."""


@dataclass(frozen=True, eq=False, repr=False)
class Comparison(answer.Comparison):
    """A run against a model, with what it was made from; `compare` returns it.

    Attributes:
        saved: The model file, where the model is of one.
        title: Names of the runs.

    Example:
        >>> found = compare("run.csv")
        >>> found.structure[0].variables
        ('T_spindle_degC',)
    """

    saved: SavedModel | None = None
    title: str = ""

    def save(self, folder: str | Path, pdf: bool = False, force: bool = False) -> Path:
        """Write comparison.json, residuals.csv and the page into a folder, whole or not at all.

        Args:
            folder: New or empty.
            pdf: Print the page into report.pdf, too.
            force: Replace the results of an earlier run.
        """
        printed_by = printer() if pdf else None
        with results_folder(folder, force, SOMETIMES) as place:
            self.write(place)
            self.write_page(place, printed_by)
        return Path(folder)

    def page(self, folder: str | Path, pdf: bool = False, force: bool = False) -> Path:
        """Write report.html with its pictures and tables into a folder; arguments as of `save`."""
        printed_by = printer() if pdf else None
        with results_folder(folder, force, SOMETIMES) as place:
            self.write_page(place, printed_by)
        return Path(folder) / "report.html"

    def write(self, folder: Path) -> str:
        """Write the results, without a page, into a folder that is there.

        Returns:
            A line on the machine of a serial arm as it was found; "" for any other machine.
        """
        with deviations_in(self.run.touches.deviation_unit):
            write_comparison(
                folder / "comparison.json",
                self,
                [structure_words(s) for s in self.structure],
                [remark_sentence(r) for r in self.remarks],
            )
            write_residuals(folder / "residuals.csv", self)
            return "" if self.saved else write_found_arm(folder, self.fit, self.title)

    def write_page(self, folder: Path, printed_by: Printer | None = None) -> None:
        """Write the page into a folder that is there."""
        reported = self.saved.reported if self.saved else None
        with deviations_in(self.run.touches.deviation_unit):
            write_compare_page(self, folder, self.title, np.random.default_rng(0), reported)
            if printed_by is not None:
                write_pdf(folder / "report.html", folder / "report.pdf", printed_by)


def compare(
    runs: Runs,
    model: StartingModel = GEOMETRY,
    *,
    pitch: Mapping[str, float] | None = None,
    progress: Progress = quiet,
) -> Comparison:
    """Measured against predicted deviations, and where the model fails.

    Args:
        runs: A run, the path of a run file, or several of one machine.
        model: `"geometry"`: the ordinary geometric model, fitted to the run; `"setup"`: where the
            standard stands, no more; a model, or the path of a model file: with what it learnt from
            another run it predicts this one.
        pitch: Pitches of screws or scales by axis, mm.
        progress: Called with the share done and what is being done.

    Raises:
        BadFile: A file that cannot be read, or a model of another machine.
        NotEnoughData: So few touches that nothing can be said.

    Example:
        >>> found = compare("run.csv")
        >>> f"{1e3 * found.rms_measured:.1f} µm measured, {1e3 * found.rms:.1f} µm remain"
        '19.1 µm measured, 0.8 µm remain'
    """
    run, start, saved, title = starting_run(
        runs, model, "so the agreement is optimistic", pitch=pitch
    )
    found = answer.compare(
        run,
        start,
        saved.estimates if saved else None,
        progress,
        saved.learnt(without_copies(run)) if saved else None,
    )
    known = {f.name: getattr(found, f.name) for f in fields(found)}
    return Comparison(**known, saved=saved, title=title)
