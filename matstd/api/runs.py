"""Runs as comparison and diagnosis take them: read, joined, and the model they begin with."""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import replace
from pathlib import Path

import numpy as np

from matstd.diagnosis.faults import faults_of_refused
from matstd.diagnosis.files import SavedModel, check_machine, read_model
from matstd.diagnosis.fit import MIN_TOUCHES
from matstd.effect_kinds import register_effects
from matstd.options import GEOMETRY, SETUP
from matstd.report.geometry import copy_lines, fault_sentences
from matstd.report.words import remark_sentence
from matstd.twin import files
from matstd.twin.errors import BadArgument, BadFile, DesignError, NotEnoughData
from matstd.twin.library import kinds, ordinary_model, try_kind, users_files
from matstd.twin.model import Model
from matstd.twin.record import Run, joined

Runs = Run | str | Path | Sequence[Run | str | Path]
"""A run, the path of its file, or several of them."""

StartingModel = str | Path | Model | SavedModel
"""`"geometry"`, `"setup"`, the path of a model file, or a model."""


def read_run(path: str | Path) -> Run:
    """Measurements from a run file (docs/formats/measurements.md), with the machine that it names.

    Raises:
        BadFile: File, line and column, what stood there, what was expected.
        DesignError: Deviations far beyond every machine error; the message names the mistake in
            the description that would explain them, where there is one.

    Example:
        >>> run = read_run("run.csv")
        >>> len(run), run.touches.chain.name
        (390, 'Mikron HSM 600U')
    """
    try:
        return files.read_run(path)
    except BadFile as refusal:
        run = refusal.facts.get("run")
        faults = faults_of_refused(run) if isinstance(run, Run) else ()
        if not isinstance(run, Run) or not faults:
            raise
        said = [*fault_sentences(faults), *copy_lines(run.touches, None, faults)]
        raise DesignError("; ".join([str(refusal), *said])) from refusal


def starting_run(
    runs: Runs,
    model: StartingModel,
    same: str,
    hold_out: Sequence[str] = (),
    pitch: Mapping[str, float] | None = None,
) -> tuple[Run, Model, SavedModel | None, str]:
    """What compare and diagnose begin with.

    Args:
        same: What follows where the model was learnt from this very run, for the remark.
        hold_out: Names of runs of which nothing is to be learnt.
        pitch: Of axes whose pitch is stated, mm.

    Returns:
        All runs as one, the starting model, the file that it is of if it is of one, and the names
        of the runs as a title.

    Raises:
        BadFile: Any of the files, or a model of another machine.
        DesignError: Runs that cannot be diagnosed together, or nothing left to learn from.
        NotEnoughData: Too few touches to place the standard.
    """
    register_effects()
    given = listed(runs)
    run = _joined(given, hold_out)
    own = users_files()
    for kind in (k for k in kinds() if k.word in own):
        try_kind(kind, run.touches, own[kind.word])
    title = ", ".join("run" if isinstance(one, Run) else Path(one).name for one in given)
    start, saved = _starting_model(model, run)
    if saved is not None:
        name = str(model) if isinstance(model, str | Path) else f"model of {saved.source.run}"
        check_machine(saved, run.touches.chain, name)
        said = [remark_sentence(one) for one in saved.of_other_runs]
        if is_learnt_from(saved, run):
            said.append(f"{name} was learnt from this very run, {same}")
        run = replace(run, remarks=(*run.remarks, *said))
    chain = run.touches.chain
    for axis, length in (pitch or {}).items():
        chain = chain.with_pitch(axis, length)
    # a starting model that was not stated is that of the machine with its pitches
    run = replace(run, touches=replace(run.touches, chain=chain))
    return run, start or _of_word(model, run), saved, title


def _starting_model(given: StartingModel, run: Run) -> tuple[Model | None, SavedModel | None]:
    """A model that is stated; nothing for a word."""
    if isinstance(given, Model):
        return given, None
    if isinstance(given, str) and given in (SETUP, GEOMETRY):
        return None, None
    if isinstance(given, str) and not (Path(given).suffix or Path(given).exists()):
        raise BadArgument("model", given, f"{GEOMETRY}, {SETUP} or a model file")
    saved = given if isinstance(given, SavedModel) else read_model(given, runs=[run])
    return saved.model, saved


def _of_word(word: StartingModel, run: Run) -> Model:
    chain = run.touches.chain
    return Model(chain, ()) if word == SETUP else ordinary_model(chain)


def is_learnt_from(saved: SavedModel, run: Run) -> bool:
    """Whether the estimates of a model rest upon this very run, or upon one of several."""
    return not set(run.fingerprints).isdisjoint(saved.source.learnt_from)


def listed(runs: Runs) -> list[Run | str]:
    """Runs, or the paths of their files as text."""
    several = [runs] if isinstance(runs, Run | str | Path) else runs
    return [one if isinstance(one, Run) else str(one) for one in several]


def _joined(given: Sequence[Run | str], hold_out: Sequence[str]) -> Run:
    """All runs as one, by their names; those held out are marked so."""
    paths = [one for one in given if isinstance(one, str)]
    for path in paths:
        if paths.count(path) > 1:
            raise DesignError(f"{path}: given twice, expected every run once")
    names = names_of(given)
    for name in hold_out:
        if name not in paths and name not in names:
            raise BadArgument("hold_out", name, f"one of {', '.join(names)}")
    if not given:
        raise BadArgument("runs", "none", "one run or more")
    runs = {}
    for name, one in zip(names, given, strict=True):
        run = one if isinstance(one, Run) else read_run(one)
        if len(run) < MIN_TOUCHES:
            raise NotEnoughData(
                f"{name if isinstance(one, Run) else one}: {len(run)} "
                f"touch{'es' if len(run) > 1 else ''}, expected at least "
                f"{MIN_TOUCHES}: fewer cannot even place the standard; add touches"
                + "".join(f"; {remark}" for remark in run.remarks)
            )
        is_held_out = name in hold_out or (isinstance(one, str) and one in hold_out)
        runs[name] = replace(run, split=np.full(len(run), "test")) if is_held_out else run
    if all((run.split == "test").all() for run in runs.values()):
        raise BadArgument("hold_out", " ".join(hold_out), "at least one run to fit; no run is left")
    return joined(runs)


def names_of(
    given: Sequence[Run | str], named: Callable[[Path], str] = lambda path: path.stem
) -> list[str]:
    """A name for each run; whole paths where the short ones are not unique."""
    paths = [f"run {i}" if isinstance(one, Run) else one for i, one in enumerate(given, start=1)]
    names = [named(Path(one)) for one in paths]  # "run 1" is its own stem
    return names if len(set(names)) == len(names) else paths
