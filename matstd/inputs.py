"""What compare and diagnose begin with: a run, a model that fits it, effects of the user's own."""

from collections.abc import Iterable, Sequence
from dataclasses import replace
from pathlib import Path

import numpy as np

from matstd.diagnosis.choice import candidate_effects
from matstd.diagnosis.faults import faults_of_refused
from matstd.diagnosis.files import SavedModel, check_machine, read_model
from matstd.diagnosis.fit import MIN_TOUCHES
from matstd.options import load_effects
from matstd.report.geometry import copy_lines, fault_sentences
from matstd.report.words import remark_sentence
from matstd.twin.errors import BadFile, DesignError, NotEnoughData
from matstd.twin.files import read_run
from matstd.twin.library import (
    is_visible,
    kinds,
    parse_effect,
    try_effect,
    try_kind,
    users_files,
)
from matstd.twin.model import Effect
from matstd.twin.record import Run, joined


def read_inputs(
    run_files: Sequence[str],
    model_file: str | None,
    effect_files: Iterable[str],
    same: str,
    held_out: Sequence[str] = (),
) -> tuple[Run, SavedModel | None]:
    """A run, or several joined, and the model that it is held against.

    Args:
        run_files: Measurements of one machine.
        model_file: Of an earlier diagnosis; None for none.
        effect_files: Python files with effects of the user's own.
        same: What follows where the model was learnt from this very run, for the remark.
        held_out: Those of the files, or their names, of which nothing is to be learnt.

    Raises:
        BadFile: Any of the files, or a model of another machine.
        DesignError: Runs that cannot be diagnosed together, or nothing left to learn from.
        NotEnoughData: Too few touches to place the standard.
    """
    load_effects(effect_files)
    run = _joined(run_files, held_out)
    own = users_files()
    for kind in (k for k in kinds() if k.word in own):
        try_kind(kind, run.touches, own[kind.word])
    if model_file is None:
        return run, None
    saved = read_model(model_file, runs=[run])
    check_machine(saved, run.touches.chain, model_file)
    told = [remark_sentence(one) for one in saved.left_out]
    if is_learnt_from(saved, run):
        told.append(f"{model_file} was learnt from this very run, {same}")
    return replace(run, remarks=(*run.remarks, *told)), saved


def _joined(run_files: Sequence[str], held_out: Sequence[str]) -> Run:
    """All runs as one, by the names of their files; those held out are marked so."""
    names = _names(run_files)
    for name in held_out:
        if name not in run_files and name not in names:
            raise DesignError(f"--hold-out {name}: expected one of {', '.join(names)}")
    runs = {}
    for name, path in zip(names, run_files, strict=True):
        run = _read(path)
        if len(run) < MIN_TOUCHES:
            raise NotEnoughData(
                f"{path}: {len(run)} touch{'es' if len(run) > 1 else ''}, expected at least "
                f"{MIN_TOUCHES}: fewer cannot even place the standard; add touches"
                + "".join(f"; {remark}" for remark in run.remarks)
            )
        is_held_out = name in held_out or path in held_out
        runs[name] = replace(run, split=np.full(len(run), "test")) if is_held_out else run
    if all((run.split == "test").all() for run in runs.values()):
        raise DesignError(
            f"--hold-out {' '.join(held_out)}: no run is left to fit, expected at least one"
        )
    return joined(runs)


def _names(run_files: Sequence[str]) -> list[str]:
    """Names of files without their endings; with their folders where those alone tell them apart.

    Raises:
        DesignError: A file that is given twice.
    """
    for path in run_files:
        if list(run_files).count(path) > 1:
            raise DesignError(f"{path}: given twice, expected every run once")
    names = [Path(path).stem for path in run_files]
    return names if len(set(names)) == len(names) else list(run_files)


def with_pitches(run: Run, stated: Iterable[str]) -> Run:
    """A run on a machine whose pitches are stated, `X=10`, in mm.

    Raises:
        DesignError: No axis and number, an axis given twice, an axis without a pitch.
        UnknownAxis: The machine has no such axis.
    """
    chain = run.touches.chain
    given: set[str] = set()
    for text in stated:
        axis, _, number = (part.strip() for part in text.partition("="))
        try:
            pitch = float(number)
        except ValueError:
            expected = "expected an axis and its pitch in mm, such as X=10"
            raise DesignError(f"--pitch {text}: {expected}") from None
        if axis in given:
            raise DesignError(f"--pitch {text}: {axis} is given twice, expected every axis once")
        given.add(axis)
        chain = chain.with_pitch(axis, pitch)
    return replace(run, touches=replace(run.touches, chain=chain))


def _read(run_file: str) -> Run:
    """The run; a refusal for its deviations says which mistake in the description makes it fit."""
    try:
        return read_run(run_file)
    except BadFile as refusal:
        run = refusal.facts.get("run")
        faults = faults_of_refused(run) if isinstance(run, Run) else ()
        if not isinstance(run, Run) or not faults:
            raise
        told = [*fault_sentences(faults), *copy_lines(run.touches, None, faults)]
        raise DesignError("; ".join([str(refusal), *told])) from refusal


def is_learnt_from(saved: SavedModel, run: Run) -> bool:
    """Whether the estimates of a model rest upon this very run, or upon one of several."""
    return not set(run.fingerprints).isdisjoint(saved.source.learnt_from)


def named_effects(names: Iterable[str], known: Iterable[Effect], run: Run) -> list[Effect]:
    """Effects that a user wants to add.

    Args:
        names: As given.
        known: Effects that are in the model already.

    Raises:
        UnknownEffect, UnknownAxis, UnknownSymbol: A name that means nothing here.
        DesignError: An effect that the model already has, that is given twice, or that moves
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
            raise DesignError(f"--add {name}: is already in the model, expected another effect")
        if effect.name in {e.name for e in out}:
            raise DesignError(f"--add {name}: given twice, expected every effect once")
        if not is_visible(effect, run.touches):
            raise DesignError(
                f"--add {name}: has no effect at these touches, expected one that has"
            )
        out.append(effect)
    return out


def candidates(only: Sequence[str], without: Sequence[str], run: Run) -> list[Effect] | None:
    """Effects that may be found, narrowed by the user; None for all that make sense.

    Args:
        only: Kinds, or names of effects; empty for all.
        without: Kinds, or names of effects, that are left out.

    Raises:
        DesignError: A word that is no kind and no effect of this run, or nothing is left.
    """
    if not only and not without:
        return None
    everything = candidate_effects(run.touches)
    words = {k.word for k in kinds()}
    names = {_plain(e.name) for e in everything}
    for option, given in (("--only", only), ("--without", without)):
        for word in given:
            if word not in words and _plain(word) not in names:
                raise DesignError(
                    f"{option} {word}: expected a kind ({', '.join(sorted(words))}) or an effect "
                    "that this run could show (matstd effects)"
                )
    out = [e for e in everything if not only or _is_among(e, only)]
    out = [e for e in out if not _is_among(e, without)]
    if not out:
        raise DesignError(
            f"--only {' '.join(only)} --without {' '.join(without)}: nothing is left to search "
            "for, expected at least one effect that this run could show"
        )
    return out


def _plain(name: str) -> str:
    return name.replace(" ", "")


def _is_among(effect: Effect, words: Iterable[str]) -> bool:
    return any(w == effect.kind or _plain(w) == _plain(effect.name) for w in words)
