"""`matstd compare`: measurements against a model, and where it fails."""

from __future__ import annotations

import argparse
from pathlib import Path
from typing import TYPE_CHECKING

from matstd.folder import FOUND, write_found_arm
from matstd.options import (
    REPORT_FILES,
    add_measured,
    asked_printer,
    first_model,
    model_file,
    print_report,
)
from matstd.twin.files import results_folder

if TYPE_CHECKING:
    from matstd.diagnosis.answer import Comparison
    from matstd.diagnosis.files import SavedModel
    from matstd.twin.record import Run

CLEAR = 2.0
"""Standard uncertainties from which a region is off on average, and does not merely scatter."""

OURS = (FOUND, "pictures/*.png", *REPORT_FILES)
"""Results that not every comparison leaves."""


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Arguments of the command."""
    parser.add_argument("run_file", metavar="RUN.csv", help="measurements")
    add_measured(
        parser,
        "the run is compared with its predictions (default: the ordinary geometric model, fitted)",
    )


def run(args: argparse.Namespace) -> int:
    """Compare; the folder appears whole or not at all."""
    from matstd.inputs import read_inputs, with_pitches
    from matstd.twin.words import deviations_in

    run, saved = read_inputs(
        [args.run_file], model_file(args), args.effects, "so the agreement is optimistic"
    )
    run = with_pitches(run, args.pitch)
    with deviations_in(run.touches.deviation_unit):
        return _compared(args, run, saved)


def _compared(args: argparse.Namespace, run: Run, saved: SavedModel | None) -> int:
    """The comparison as files and in words."""
    import numpy as np

    from matstd.diagnosis.answer import compare
    from matstd.diagnosis.files import write_comparison, write_residuals
    from matstd.progress import stages, turns
    from matstd.report.words import remark_sentence, structure_words
    from matstd.twin.record import without_copies

    model = saved.model if saved else first_model(args, run.touches.chain)
    printed_by = asked_printer(args)
    with results_folder(args.output, args.force, OURS) as folder, stages() as show:
        found = compare(
            run,
            model,
            saved.estimates if saved else None,
            turns(show),
            saved.learnt(without_copies(run)) if saved else None,
        )
        write_comparison(
            folder / "comparison.json",
            found,
            [structure_words(s) for s in found.structure],
            [remark_sentence(r) for r in found.remarks],
        )
        write_residuals(folder / "residuals.csv", found)
        arm = "" if saved else write_found_arm(folder, found.fit, Path(args.run_file).name)
        if not args.no_report:
            from matstd.report.pages import write_compare_page

            show("report", 0, 1)
            title = Path(args.run_file).name
            told = saved.told if saved else None
            write_compare_page(found, folder, title, np.random.default_rng(0), told)
            print_report(folder, printed_by)
    _tell(args, found, saved, arm)
    return 0


def _tell(args: argparse.Namespace, found: Comparison, saved: SavedModel | None, arm: str) -> None:
    """The comparison in words, beside what the model promised, or what it was learnt with."""
    from matstd.console import say
    from matstd.report.geometry import console_lines
    from matstd.report.numbers import microns, signed
    from matstd.report.words import (
        comparison_sentence,
        learnt_lines,
        promise_sentence,
        region_words,
        remark_sentence,
    )
    from matstd.twin.units import UM

    say(comparison_sentence(found), style="bold")
    if found.learnt is not None and saved is not None:
        for line in learnt_lines(found.learnt, saved.told):
            say(line)
    elif saved is not None and saved.source.held_out_um > 0.0:
        say(promise_sentence(found, saved.source.held_out_um * UM, saved.left_out))
    for region in found.where:
        mean = signed(region.mean / UM, region.u / UM, "µm")
        is_off = abs(region.mean) > CLEAR * region.u
        size = mean if is_off else f"{microns(region.rms)} rms"
        say(f"{region_words(region.conditions)}: {size} ({int(region.rows.sum())} touches)")
    for line, is_first in console_lines(found.run.touches, found.geometry, found.faults):
        say(f"- {line}", style="bold" if is_first else None)
    for line in filter(None, [arm, *map(remark_sentence, found.remarks)]):
        say(f"- {line}")
    first = "" if args.no_report else "report.html, "
    say(f"{args.output}: look at {first}comparison.json, residuals.csv")
