"""`matstd compare`: measurements against a model, and where it fails."""

from __future__ import annotations

import argparse
from pathlib import Path
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from diagnosis.residuals import Comparison


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Arguments of the command."""
    parser.add_argument("run_file", metavar="RUN.csv", help="measurements")
    parser.add_argument(
        "--model",
        metavar="MODEL.toml",
        help="predict with this one; without it the ordinary geometric model is fitted to the run",
    )
    parser.add_argument(
        "--effects", metavar="FILE.py", action="append", default=[], help="effects of your own"
    )
    parser.add_argument("--no-report", action="store_true", help="no pictures and no page")
    parser.add_argument("-o", "--output", metavar="OUT", required=True, help="folder to be made")
    parser.add_argument("--force", action="store_true", help="replace results of an earlier run")


def run(args: argparse.Namespace) -> int:
    """Compare; the folder appears whole or not at all."""
    import numpy as np

    from diagnosis.diagnosis_file import write_comparison, write_residuals
    from diagnosis.model_file import read_model
    from diagnosis.residuals import compare
    from matstd.console import stages
    from matstd.folder import results_folder
    from twin.files.run_file import read_run
    from twin.library import load_installed_effects, load_user_effects
    from twin.ordinary import ordinary_model

    load_installed_effects()
    for path in args.effects:
        load_user_effects(Path(path))
    run = read_run(args.run_file)
    saved = read_model(args.model) if args.model else None
    model = saved.model if saved else ordinary_model(run.touches.chain)
    with results_folder(args.output, args.force) as folder, stages() as show:
        found = compare(
            run,
            model,
            saved.estimates if saved else None,
            lambda share, doing: show(doing, int(100 * share), 100),
        )
        write_comparison(folder / "comparison.json", found)
        write_residuals(folder / "residuals.csv", found)
        if not args.no_report:
            from matstd.report_compare import write_compare_page

            show("report", 0, 1)
            title = Path(args.run_file).name
            write_compare_page(found, folder, title, np.random.default_rng(0))
    _tell(args, found)
    return 0


def _tell(args: argparse.Namespace, found: Comparison) -> None:
    """The comparison in words."""
    from rich.console import Console

    from diagnosis.residuals import comparison_sentence
    from twin.units import UM

    console = Console(highlight=False)
    console.print(comparison_sentence(found), markup=False, style="bold")
    for region in found.where:
        console.print(
            f"{region.words}: {region.mean / UM:+.2f} µm ({int(region.rows.sum())} touches)",
            markup=False,
        )
    for remark in found.remarks:
        console.print(f"- {remark}", markup=False)
    first = "" if args.no_report else "report.html, "
    console.print(f"{args.output}: look at {first}comparison.json, residuals.csv", markup=False)
