"""Laws that no library has: learnt from a run, with files, page and an effect of the user's own."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path

from matstd.api.diagnosing import named_effects
from matstd.api.runs import Runs, StartingModel, read_run, starting_run
from matstd.api.saved import (
    EFFECT,
    REPORT_FILES,
    VISIT,
    Saveable,
    extended,
    next_visit,
    write_learnt,
)
from matstd.api.standards import Probed, probed_body
from matstd.diagnosis import laws
from matstd.diagnosis.files import SavedModel, model_text, parsed_model
from matstd.diagnosis.fit import prior_for
from matstd.diagnosis.geometry import LearntGeometry, learnt_geometry
from matstd.diagnosis.laws import SecondRun, learn_laws
from matstd.diagnosis.next_visit import VisitPlan
from matstd.diagnosis.remarks import remarks
from matstd.diagnosis.search import DiagnosisTask, refined_named
from matstd.options import GEOMETRY
from matstd.report.laws import effect_text, law_sentence, no_law_sentence, write_law_page
from matstd.report.run_view import Framed, learnt_view
from matstd.report.words import remark_sentence
from matstd.twin.display import Displayed
from matstd.twin.errors import BadArgument
from matstd.twin.files import write_whole
from matstd.twin.frames import Array
from matstd.twin.model import Model
from matstd.twin.record import Run
from matstd.twin.versions import versions
from matstd.twin.words import deviations_in


@dataclass(frozen=True, eq=False, repr=False)
class LearntLaws(Saveable, Displayed, laws.Learning):
    """Laws that explain what a model leaves of a run; `learn` returns it.

    Example:
        >>> found = learn("run.csv", add=["thermal-lag(EZZ)"])
        >>> found.laws, found.effect_text
        ((), '')
    """

    sometimes = (EFFECT, VISIT, "pictures/*.png", *REPORT_FILES)
    second: SecondRun | None = None  # what a second run says of them; None without one
    title: str = ""  # names of the runs
    body: Array | None = None  # triangles of what was probed, where it is known

    @property
    def model_text(self) -> str:
        """Text of the model file, the laws in it."""
        made_with = f"material-standard {versions()['material-standard']}"
        known = [row for row in self.geometry.rows if row.is_determined]
        return model_text(
            self.saved, self.title, made_with=made_with, determined=known, shares=self.shares
        )

    @cached_property
    def geometry(self) -> LearntGeometry:
        """What the run says of the geometry, the laws in the model."""
        return learnt_geometry(self.after)

    @property
    def model(self) -> SavedModel:
        """What the model file says of the machine, for another run or a compensation."""
        return parsed_model(self.model_text, "model.toml", self.saved.model.effects)

    @property
    def effect_text(self) -> str:
        """Text of `effect.py`; "" where no law was learnt."""
        return effect_text(self, self.title) if self.laws else ""

    @property
    def remarks(self) -> list[str]:
        """What else is to be known of the run: gross errors left out, noise, few touches."""
        return [remark_sentence(one) for one in remarks(self.after, self.before)]

    @cached_property
    def visit(self) -> VisitPlan:
        """The visit after which the odds between the laws and their rivals are largest."""
        return next_visit(self)

    def write(self, folder: Path) -> str:
        """Write law.json, model.toml, effect.py of a law, next_visit.csv; as of `Saveable`."""
        with deviations_in(self.after.run.touches.deviation_unit):
            write_learnt(folder, self, self.title, self.visit, self.second)
            write_whole(folder / "model.toml", self.model_text)
        return ""

    def live(self) -> Framed:
        """The live view, for a notebook: switch the laws, and see the error and their curves."""
        lead = " ".join(law_sentence(self, one) for one in self.laws) or no_law_sentence(self)
        with deviations_in(self.after.run.touches.deviation_unit):
            return Framed(self.title, lead, learnt_view(self, self.title, self.body))

    def write_page(self, folder: Path) -> None:
        """Write the page into an existing folder."""
        with deviations_in(self.after.run.touches.deviation_unit):
            live = learnt_view(self, self.title, self.body)
            notes = self.remarks
            write_law_page(self, folder, self.title, self.visit, self.second, live, notes)


def learn(
    runs: Runs,
    model: StartingModel = GEOMETRY,
    *,
    add: Sequence[str] = (),
    second_run: Run | str | Path | None = None,
    pitch: Mapping[str, float] | None = None,
    standard: Probed = None,
) -> LearntLaws:
    """Learn laws that a model lacks: what carries them, what they depend on, and their formula.

    Args:
        runs: A run, the path of a run file, or several of one machine in their order.
        model: Starting model: `"geometry"`, `"setup"`, a model, or the path of a model file, whose
            effects are fitted anew.
        add: Effects that are in the model besides, by name.
        second_run: Another run of the machine, in which the laws are tried.
        pitch: Pitches of screws or scales by axis, mm.
        standard: What was probed, for the page: a standard, or the path of its file or of a drawing
            (STL, OBJ, PLY, STEP; mm, artefact frame). `standard.toml` beside the run without it.

    Raises:
        BadFile: A file that cannot be read, or a model of another machine.
        BadArgument: A name that means nothing here, or a second run that is one of the first.
        NotEnoughData: So few touches that nothing can be said.

    Example:
        >>> found = learn("run.csv", add=["thermal-lag(EZZ)"])
        >>> f"{1e3 * found.after.rms:.2f} µm remain, {len(found.laws)} laws"
        '0.56 µm remain, 0 laws'
    """
    same = "so that its estimates are made anew: no touch counts twice"
    run, start, _, title = starting_run(runs, model, same, pitch=pitch)
    run, body = probed_body(standard, runs, run)
    other = read_run(second_run) if isinstance(second_run, str | Path) else second_run
    if other is not None and not set(run.fingerprints).isdisjoint(other.fingerprints):
        raise BadArgument("second_run", "has touches that the laws are learnt from", "another run")
    added = named_effects(add, start.effects, run)
    if added:  # a time constant at a point of its grid leaves a law that is none
        task = DiagnosisTask(run, start, prior_for(run, start))
        added = [sized.effect for sized in refined_named(task, added)]
    found = learn_laws(run, Model(start.chain, (*start.effects, *added)))
    said = None if other is None or not found.laws else laws.second_run(found, other)
    return extended(LearntLaws, found, second=said, title=title, body=body)
