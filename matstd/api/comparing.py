"""Measurements against a model: the result with its files and its page."""

from collections.abc import Mapping
from dataclasses import dataclass, fields
from pathlib import Path

import numpy as np

from matstd.api.runs import GEOMETRY, Runs, StartingModel, starting_run
from matstd.api.saved import FOUND, REPORT_FILES, Saveable, write_found_arm
from matstd.diagnosis import answer
from matstd.diagnosis.evidence import Progress, quiet
from matstd.diagnosis.files import SavedModel, write_comparison, write_residuals
from matstd.report.pages import Printer, write_compare_page, write_pdf
from matstd.report.run_view import Framed, comparison_view
from matstd.report.words import comparison_sentence, remark_sentence, structure_words
from matstd.twin.record import without_copies
from matstd.twin.words import deviations_in


@dataclass(frozen=True, eq=False, repr=False)
class Comparison(Saveable, answer.Comparison):
    """A run against a model, with what it was made from; `compare` returns it.

    Attributes:
        saved: The model file, where the model is of one.
        title: Names of the runs.

    Example:
        >>> found = compare("run.csv")
        >>> found.structure[0].variables
        ('T_spindle_degC',)
    """

    sometimes = (FOUND, "pictures/*.png", *REPORT_FILES)
    saved: SavedModel | None = None
    title: str = ""

    def write(self, folder: Path) -> str:
        """Write comparison.json and residuals.csv into an existing folder; as of `Saveable`."""
        with deviations_in(self.run.touches.deviation_unit):
            write_comparison(
                folder / "comparison.json",
                self,
                [structure_words(s) for s in self.structure],
                [remark_sentence(r) for r in self.remarks],
            )
            write_residuals(folder / "residuals.csv", self)
            return "" if self.saved else write_found_arm(folder, self.fit, self.title)

    def live(self) -> Framed:
        """The live view: in a notebook effects are switched where it is shown."""
        with deviations_in(self.run.touches.deviation_unit):
            view = comparison_view(self, self.title)
            return Framed(f"{self.title} against the model", comparison_sentence(self), view)

    def write_page(self, folder: Path, printed_by: Printer | None = None) -> None:
        """Write the page into an existing folder."""
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
