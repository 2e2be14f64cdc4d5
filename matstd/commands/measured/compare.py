"""`matstd compare`: measurements against a model, and where it fails."""

from __future__ import annotations

import argparse
from typing import TYPE_CHECKING

from matstd.commands.measured.results import made_in_folder, say_files
from matstd.console import say, say_each
from matstd.options import Options, measured, pitches, starting_model
from matstd.twin.words import deviations_in

if TYPE_CHECKING:
    from matstd.api.diagnosing import Comparison
    from matstd.twin.compute import Progress


OPTIONS: Options = {
    "run_file RUN.csv": "measurements",
    **measured(
        "the run is compared with its predictions (default: the ordinary geometric model, fitted)"
    ),
}


def run(args: argparse.Namespace) -> int:
    """Compare; the folder appears whole or not at all."""
    from matstd.api.diagnosing import Comparison, compare
    from matstd.progress import turns

    def make(show: Progress) -> Comparison:
        return compare(
            args.run_file,
            starting_model(args),
            pitch=pitches(args),
            standard=args.standard,
            progress=turns(show),
        )

    found, arm = made_in_folder(args, Comparison, make)
    with deviations_in(found.run.touches.deviation_unit):
        _report(args, found, arm)
    return 0


def _report(args: argparse.Namespace, found: Comparison, arm: str) -> None:
    """The comparison in words, beside what the model promised, or what it was learnt with."""
    from matstd.report.geometry import console_lines
    from matstd.report.verdict import promise_sentence, promise_words, repeatability_words
    from matstd.report.words import (
        comparison_sentence,
        learnt_lines,
        region_sentence,
        remark_sentence,
    )

    saved = found.saved
    say(comparison_sentence(found), style="bold")
    if found.learnt is not None and saved is not None:
        for line in learnt_lines(found.learnt, saved.reported):
            say(line)
    elif saved is not None and saved.source.promise is not None:
        say(promise_sentence(found, saved.source.promise, saved.left_out))
    say(f"- repeatability: {repeatability_words(found.repeatability, found.scatter)}")
    if found.promise is not None:
        say(f"- error to expect: {promise_words(found.promise)}")
    say_each(map(region_sentence, found.where))
    for line, is_first in console_lines(found.run.touches, found.geometry, found.faults):
        say(f"- {line}", style="bold" if is_first else None)
    say_each(filter(None, [arm, *map(remark_sentence, found.remarks)]))
    say_files(args, "comparison.json", "residuals.csv")
