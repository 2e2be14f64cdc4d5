"""`matstd learn`: a law for what a model leaves, where the library has none."""

from __future__ import annotations

import argparse
from pathlib import Path
from typing import TYPE_CHECKING

from matstd.commands.measured.results import made_in_folder, say_files
from matstd.console import say, say_each
from matstd.options import Options, measured, pitches, starting_model
from matstd.twin.words import deviations_in

if TYPE_CHECKING:
    from matstd.api.learning import LearntLaws
    from matstd.twin.compute import Progress


OPTIONS: Options = {
    "run_files RUN.csv ...": "measurements; several runs of one machine in order of time",
    "--second-run RUN2.csv": "another run of the machine, in which the law is tried; nothing is "
    "learnt from it",
    "--add EFFECT ...": "effects that are in the model besides",
    **measured("model in which a law is missing (default: the ordinary geometric model)"),
}


def run(args: argparse.Namespace) -> int:
    """Learn; the folder appears whole or not at all."""
    from matstd.api.learning import LearntLaws, learn

    def make(show: Progress) -> LearntLaws:
        show("law", 0, 1)
        return learn(
            args.run_files,
            starting_model(args),
            add=args.add,
            second_run=args.second_run,
            pitch=pitches(args),
            standard=args.standard,
        )

    found, _ = made_in_folder(args, LearntLaws, make)
    with deviations_in(found.after.run.touches.deviation_unit):
        _report(args, found)
    args.next = _next(args, found)
    return 0


def _next(args: argparse.Namespace, found: LearntLaws) -> tuple[str, str]:
    """A law gets a name, once a visit has distinguished it from its rivals; without one measure."""
    from matstd.next_steps import MODELLED, called, kept

    same = kept(args, *MODELLED, "add")
    out, again = Path(args.output), f"{args.output}-2"
    if not found.laws:
        words = called("learn", *args.run_files, "again.csv", *same, "-o", again)
        return words, "after another run that records what could be the cause"
    named = [one.library.effect.name for one in found.laws if one.is_of_library and one.library]
    if named:
        words = called("diagnose", *args.run_files, *same, "--add", *named, "-o", again)
        return words, "the effect of the library that explains as much as the law, or more"
    if found.visit.touches is not None:
        words = called("learn", *args.run_files, "visit.csv", *same, "-o", again)
        plan = out / "next_visit.csv"
        return words, f"after measuring {plan}; matstd replan writes its programs"
    named = [word for name in found.effect_names for word in ("--add", name)]
    same += ["--effects", out / "effect.py", *named]
    words = called("diagnose", *args.run_files, *same, "-o", again)
    return words, "the law by the name that you give it in effect.py"


def _report(args: argparse.Namespace, found: LearntLaws) -> None:
    """The law, its rival, its errors elsewhere, and the files."""
    from matstd.report.laws import (
        held_out_sentence,
        law_notes,
        law_sentence,
        no_law_sentence,
        rival_sentence,
        second_run_sentence,
        visit_sentences,
    )
    from matstd.report.numbers import sentence

    if not found.laws:
        say(no_law_sentence(found), style="bold")
    for one in found.laws:
        say(sentence(law_sentence(found, one)), style="bold")
        if second := rival_sentence(one):
            say(f"- {second}")
    say_each(law_notes(found))
    if found.laws:
        say(f"- {held_out_sentence(found)}")
    say_each(visit_sentences(found.visit))
    if found.second is not None:
        say(f"- {second_run_sentence(found.second)}")
    say_each(found.remarks)
    effect = "effect.py (--effects)" if found.laws else ""
    visit = "" if found.visit.touches is None else "next_visit.csv"
    say_files(args, effect, visit, "law.json", "model.toml")
