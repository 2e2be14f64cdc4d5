"""What a model leaves of a run and what it lacks: results with files, page and compensation."""

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from matstd.api.runs import Runs, StartingModel, is_learnt_from, starting_run
from matstd.api.saved import (
    EFFECT,
    FOUND,
    LAW,
    REPORT_FILES,
    VISIT,
    Saveable,
    extended,
    next_visit,
    write_found_arm,
    write_learnt,
)
from matstd.api.standards import Probed, probed_body
from matstd.diagnosis import answer
from matstd.diagnosis.choice import candidate_effects
from matstd.diagnosis.evidence import Progress, quiet
from matstd.diagnosis.files import (
    SavedModel,
    comparison_table,
    diagnosis_table,
    model_text,
    parsed_model,
    plan_text,
)
from matstd.diagnosis.fit import Fit
from matstd.diagnosis.laws import learn_remainder
from matstd.diagnosis.next_visit import VisitPlan
from matstd.options import GEOMETRY
from matstd.report.pages import write_compare_page, write_diagnosis_page
from matstd.report.run_view import Framed, comparison_view, diagnosis_view
from matstd.report.words import (
    comparison_sentence,
    remark_sentence,
    structure_words,
    verdict_sentence,
)
from matstd.twin.errors import BadArgument
from matstd.twin.files import write_whole
from matstd.twin.files.whole import write_json
from matstd.twin.frames import Array
from matstd.twin.library import is_visible, kinds, parse_effect, try_effect, users_files
from matstd.twin.model import Effect
from matstd.twin.record import Run, without_copies
from matstd.twin.versions import versions
from matstd.twin.words import deviations_in

if TYPE_CHECKING:
    from matstd.api.compensating import Compensation


@dataclass(frozen=True, eq=False, repr=False)
class Diagnosis(Saveable, answer.Diagnosis):
    """What a model lacks, with what it was made from; `diagnose` returns it.

    Example:
        >>> found = diagnose("run.csv", only=["thermal-lag"])
        >>> found.verdict.value, [effect.kind for effect in found.found]
        ('missing effect', ['thermal-lag'])
    """

    sometimes = (
        "next_measurement_*.csv", FOUND, EFFECT, LAW, VISIT, "pictures/*.png", *REPORT_FILES
    )  # fmt: skip
    # the model file that it began with and that learnt from other runs
    before: SavedModel | None = None
    title: str = ""  # names of the runs
    named: int = 0  # number of effects that the user named
    # whether the model that is learnt has what the diagnosis found; else only effects that the user
    # named. Of an unexplained run it has what was found and the law in any case.
    auto: bool = False
    body: Array | None = None  # triangles of what was probed, where it is known

    @property
    def learnt(self) -> Fit:
        """The fit of the model that is saved and that compensates."""
        is_whole = self.auto or self.verdict is answer.Verdict.UNEXPLAINED
        if self.laws is not None and self.laws.laws and is_whole:
            return self.laws.saved
        return self.predicting if self.auto else self.steps[self.named].fit

    @property
    def model_text(self) -> str:
        """Text of the model file."""
        made_with = f"material-standard {versions()['material-standard']}"
        learnt, laws = self.learnt, self.laws if self.laws and self.laws.laws else None
        shares = laws.shares if laws is not None and learnt is laws.saved else {}
        # errors to expect are those that the console states of the same model
        stated = (
            (self.promise, laws.saved if laws else self.predicting),
            (self.promise_before, self.start),
        )
        promised = next((one for one, fit in stated if fit is learnt), None)
        reported = {s.effect.name: s.reported for s in self.steps if s.effect is not None}
        # with a law in the model, too, as console and page report them: one error has one value
        known = [row for row in self.geometry.rows if row.is_determined]
        return model_text(
            learnt, self.title, self.before, made_with, promised, reported, known, shares
        )

    @property
    def model(self) -> SavedModel:
        """What the model file says of the machine, for another run or a compensation."""
        return parsed_model(self.model_text, "model.toml", self.learnt.model.effects)

    def compensate(self, **options: Any) -> "Compensation":
        """The compensation of the machine by the model that was learnt.

        Args:
            options: As of `matstd.compensate`, `tool_length` among them.
        """
        from matstd.api.compensating import compensate

        return compensate(self, **options)

    @cached_property
    def visit(self) -> VisitPlan | None:
        """The visit that distinguishes learnt laws from their rivals; None without a law."""
        return next_visit(self.laws) if self.laws and self.laws.laws else None

    def write(self, folder: Path) -> str:
        """Write diagnosis.json, model.toml and plans of touches; as of `Saveable`."""
        with deviations_in(self.run.touches.deviation_unit):
            sentences = [remark_sentence(r) for r in self.remarks]
            write_json(folder / "diagnosis.json", diagnosis_table(self, sentences))
            write_whole(folder / "model.toml", self.model_text)
            for i, plan in enumerate(self.plans, start=1):
                write_whole(folder / f"next_measurement_{i}.csv", plan_text(plan))
            if self.visit is not None:
                assert self.laws is not None  # which a visit is planned for
                write_learnt(folder, self.laws, self.title, self.visit)
            return write_found_arm(folder, self.fit, self.title)

    def live(self) -> Framed:
        """The live view: in a notebook effects are switched where it is shown."""
        with deviations_in(self.run.touches.deviation_unit):
            view = diagnosis_view(self, self.title, self.body)
            return Framed(f"Diagnosis of {self.title}", verdict_sentence(self), view)

    def write_page(self, folder: Path) -> None:
        """Write the page into an existing folder."""
        with deviations_in(self.run.touches.deviation_unit):
            rng = np.random.default_rng(0)
            write_diagnosis_page(self, folder, self.title, rng, self.auto, self.body, self.visit)


def diagnose(
    runs: Runs,
    model: StartingModel = GEOMETRY,
    *,
    add: Sequence[str] = (),
    auto: bool = False,
    only: Sequence[str] = (),
    without: Sequence[str] = (),
    hold_out: Sequence[str] = (),
    pitch: Mapping[str, float] | None = None,
    learn: bool = True,
    standard: Probed = None,
    progress: Progress = quiet,
) -> Diagnosis:
    """Find which effects a model lacks, and how far the error falls with each.

    Args:
        runs: A run, the path of a run file, or several of one machine in their order.
        model: Starting model: `"geometry"`, `"setup"`, a model, or the path of a model file.
        add: Effects that are added to the model, by name.
        auto: Put what is found into the model that is saved, too.
        only: Kinds or names of effects that are looked for; all without it.
        without: Kinds or names of effects that are not looked for.
        hold_out: Names of runs that are excluded from the fit, only their set-ups are fitted; the
            result says how well the others predict them.
        pitch: Pitches of screws or scales by axis, mm.
        learn: Learn a law of what remains, as `matstd.learn` does, where something remains.
        standard: What was probed, for the page: a standard, or the path of its file or of a drawing
            (STL, OBJ, PLY, STEP; mm, artefact frame). `standard.toml` beside the run without it.
        progress: Called with the share done and what is being done.

    Raises:
        BadFile: A file that cannot be read, or a model of another machine.
        BadArgument: A name that means nothing here.
        NotEnoughData: So few touches that nothing can be said.

    Example:
        >>> found = diagnose("run.csv", only=["thermal-lag"])
        >>> [f"{1e3 * step.fit.test_rms:.2f} µm" for step in found.steps]
        ['1.42 µm', '0.64 µm']
    """
    same = "so that its estimates are made anew: no touch counts twice"
    run, start, saved, title = starting_run(runs, model, same, hold_out, pitch)
    run, body = probed_body(standard, runs, run)
    # a model of this very run would count its touches twice as a prior
    before = saved if saved and not is_learnt_from(saved, run) else None
    added = named_effects(add, start.effects, run)
    found = answer.diagnose(
        run,
        start,
        before.estimates if before else None,
        added,
        candidates(only, without, run),
        progress,
        np.random.default_rng(0),
    )
    if learn:
        progress(0.9, "a law of what remains")
        estimates, is_left = before.estimates if before else None, found.parts.remains.is_real
        named = found.steps[len(added)].fit
        laws = learn_remainder(named, found.fit, estimates, is_left=is_left)
        found = found if laws is None else found.with_laws(laws, estimates)
    return extended(
        Diagnosis, found, before=before, title=title, named=len(added), auto=auto, body=body
    )


def named_effects(names: Iterable[str], known: Iterable[Effect], run: Run) -> list[Effect]:
    """Effects that a user wants to add.

    Args:
        names: As given.
        known: Effects that are in the model already.

    Raises:
        UnknownEffect, UnknownAxis, UnknownSymbol: A name that means nothing here.
        BadArgument: An effect that the model already has, that is given twice, or that moves
            nothing in this run.
    """
    there = {effect.name for effect in known}
    out: list[Effect] = []
    for name in names:
        effect = parse_effect(name, run.touches.chain)
        place = users_files().get(effect.kind)
        if place is not None:
            try_effect(effect, run.touches, place)
        if effect.name in there:
            raise BadArgument("add", name, "another effect: it is already in the model")
        if effect.name in {e.name for e in out}:
            raise BadArgument("add", name, "every effect once: it is given twice")
        if not is_visible(effect, run.touches):
            raise BadArgument("add", name, "a visible effect: it has no effect at these touches")
        out.append(effect)
    return out


def candidates(only: Sequence[str], without: Sequence[str], run: Run) -> list[Effect] | None:
    """Effects that may be found, narrowed by the user; None for all that make sense.

    Args:
        only: Kinds, or names of effects; empty for all.
        without: Kinds, or names of effects, that are left out.

    Raises:
        BadArgument: A word that is no kind and no effect of this run, or nothing is left.
    """
    if not only and not without:
        return None
    everything = candidate_effects(run.touches)
    words = {k.word for k in kinds()}
    names = {_plain(e.name) for e in everything}
    for argument, given in (("only", only), ("without", without)):
        for word in given:
            if word not in words and _plain(word) not in names:
                expected = (
                    f"a kind ({', '.join(sorted(words))}) or an effect that this run could show "
                    "(matstd effects)"
                )
                raise BadArgument(argument, word, expected)
    out = [e for e in everything if not only or _is_among(e, only)]
    out = [e for e in out if not _is_among(e, without)]
    if not out:
        found = f"{' '.join(only)} --without {' '.join(without)}" if without else " ".join(only)
        expected = "at least one effect that this run could show; nothing is left to search for"
        raise BadArgument("only", found, expected)
    return out


def _plain(name: str) -> str:
    return name.replace(" ", "")


def _is_among(effect: Effect, words: Iterable[str]) -> bool:
    return any(w == effect.kind or _plain(w) == _plain(effect.name) for w in words)


@dataclass(frozen=True, eq=False, repr=False)
class Comparison(Saveable, answer.Comparison):
    """A run against a model, with what it was made from; `compare` returns it.

    Example:
        >>> found = compare("run.csv")
        >>> found.structure[0].variables
        ('T_spindle_degC',)
    """

    sometimes = (FOUND, "pictures/*.png", *REPORT_FILES)
    saved: SavedModel | None = None  # the model file, where the model is of one
    title: str = ""  # names of the runs
    body: Array | None = None  # triangles of what was probed, where it is known

    def write(self, folder: Path) -> str:
        """Write comparison.json and residuals.csv into an existing folder; as of `Saveable`."""
        with deviations_in(self.run.touches.deviation_unit):
            structure = [structure_words(s) for s in self.structure]
            remarks = [remark_sentence(r) for r in self.remarks]
            write_json(folder / "comparison.json", comparison_table(self, structure, remarks))
            write_whole(folder / "residuals.csv", self.to_csv())
            return "" if self.saved else write_found_arm(folder, self.fit, self.title)

    def live(self) -> Framed:
        """The live view: in a notebook effects are switched where it is shown."""
        with deviations_in(self.run.touches.deviation_unit):
            view = comparison_view(self, self.title, self.body)
            return Framed(f"{self.title} against the model", comparison_sentence(self), view)

    def write_page(self, folder: Path) -> None:
        """Write the page into an existing folder."""
        reported = self.saved.reported if self.saved else None
        with deviations_in(self.run.touches.deviation_unit):
            rng = np.random.default_rng(0)
            write_compare_page(self, folder, self.title, rng, reported, self.body)


def compare(
    runs: Runs,
    model: StartingModel = GEOMETRY,
    *,
    pitch: Mapping[str, float] | None = None,
    standard: Probed = None,
    progress: Progress = quiet,
) -> Comparison:
    """Measured against predicted deviations, and where the model fails.

    Args:
        runs: A run, the path of a run file, or several of one machine.
        model: `"geometry"`: the ordinary geometric model, fitted to the run; `"setup"`: where the
            standard stands, no more; a model, or the path of a model file: with what it learnt from
            another run it predicts this one.
        pitch: Pitches of screws or scales by axis, mm.
        standard: What was probed, for the page: a standard, or the path of its file or of a drawing
            (STL, OBJ, PLY, STEP; mm, artefact frame). `standard.toml` beside the run without it.
        progress: Called with the share done and what is being done.

    Raises:
        BadFile: A file that cannot be read, or a model of another machine.
        NotEnoughData: So few touches that nothing can be said.

    Example:
        >>> found = compare("run.csv")
        >>> f"{1e3 * found.rms_measured:.1f} µm measured, {1e3 * found.rms:.1f} µm remain"
        '19.3 µm measured, 0.9 µm remain'
    """
    run, start, saved, title = starting_run(
        runs, model, "so the agreement is optimistic", pitch=pitch
    )
    run, body = probed_body(standard, runs, run)
    found = answer.compare(
        run,
        start,
        saved.estimates if saved else None,
        progress,
        saved.learnt(without_copies(run)) if saved else None,
    )
    return extended(Comparison, found, saved=saved, title=title, body=body)
