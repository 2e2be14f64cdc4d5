"""`matstd trend`: control charts of one machine over several runs."""

from __future__ import annotations

import argparse
from typing import TYPE_CHECKING

from matstd.commands.measured.results import made_in_folder, say_files
from matstd.console import say, say_each
from matstd.next_steps import called, kept
from matstd.options import RESULTS, Options

if TYPE_CHECKING:
    from matstd.api.trending import Trend


OPTIONS: Options = {
    "runs RUNS ...": "folders or files of at least three runs of one machine on one standard, or "
    "of their diagnoses or model files",
    "--add EFFECT ...": "effects that are fitted to every run beside the geometry, and charted",
    **RESULTS,
}


def run(args: argparse.Namespace) -> int:
    """Chart; the folder appears whole or not at all."""
    from matstd.api.trending import Trend, trend

    runs = args.runs
    found, _ = made_in_folder(args, Trend, lambda show: trend(runs, add=args.add, progress=show))
    _report(args, found)
    args.next = _next(args, found)
    return 0


def _next(args: argparse.Namespace, found: Trend) -> tuple[str, str]:
    """After a step the runs around it are compared; else the last run is diagnosed."""
    same = kept(args, "standard", "effects", "add")
    if found.follows:
        words = called("diagnose", *found.follows, *same, "--auto", "-o", f"{args.output}-change")
        return words, "what changed, from both runs together"
    if found.is_of_models:
        words = called("trend", *args.runs, *same, "-o", f"{args.output}-2")
        return words, "after the next visit; its runs say more than its models"
    words = called("diagnose", found.paths[-1], *same, "-o", f"{args.output}-last")
    return words, "what the machine lacks now"


def _report(args: argparse.Namespace, found: Trend) -> None:
    """What changed and when, and where the files are."""
    from matstd.report.charts import history_lines, history_sentence

    say(history_sentence(found), style="bold")
    say_each(history_lines(found))
    if found.left_out:
        say(f"- no run files, left out: {', '.join(found.left_out)}")
    say_files(args, "trend.json", "trend.csv")
