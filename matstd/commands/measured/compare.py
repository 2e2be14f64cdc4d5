"""`matstd compare`: measurements against a model, and where it fails."""

from __future__ import annotations

import argparse
from typing import TYPE_CHECKING

from matstd.console import say
from matstd.options import add_measured, asked_printer, pitches, starting_model

if TYPE_CHECKING:
    from matstd.api.diagnosing import Comparison


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Arguments of the command."""
    parser.add_argument("run_file", metavar="RUN.csv", help="measurements")
    add_measured(
        parser,
        "the run is compared with its predictions (default: the ordinary geometric model, fitted)",
    )


def run(args: argparse.Namespace) -> int:
    """Compare; the folder appears whole or not at all."""
    from matstd.api.diagnosing import Comparison, compare
    from matstd.effect_kinds import register_effects
    from matstd.progress import stages, turns
    from matstd.twin.files import results_folder
    from matstd.twin.words import deviations_in

    register_effects(*args.effects)
    model, pitch, printed_by = starting_model(args), pitches(args), asked_printer(args)
    with results_folder(args.output, args.force, Comparison.sometimes) as folder, stages() as show:
        found = compare(
            args.run_file, model, pitch=pitch, standard=args.standard, progress=turns(show)
        )
        arm = found.write(folder)
        if not args.no_report:
            show("report", 0, 1)
            found.write_page(folder, printed_by)
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
    for region in found.where:
        say(f"- {region_sentence(region)}")
    for line, is_first in console_lines(found.run.touches, found.geometry, found.faults):
        say(f"- {line}", style="bold" if is_first else None)
    for line in filter(None, [arm, *map(remark_sentence, found.remarks)]):
        say(f"- {line}")
    first = "" if args.no_report else "report.html, "
    say(f"{args.output}: look at {first}comparison.json, residuals.csv")
