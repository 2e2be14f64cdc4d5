"""`matstd diagnose`: which effect the model lacks, and how far the error falls with it."""

from __future__ import annotations

import argparse
from pathlib import Path
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from collections.abc import Callable

    from diagnosis.verdict import Diagnosis
    from twin.run import Run


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Arguments of the command."""
    parser.add_argument("run_file", metavar="RUN.csv", help="measurements")
    parser.add_argument(
        "--model", metavar="MODEL.toml", help="begin with this one, not the ordinary geometric one"
    )
    parser.add_argument(
        "--add",
        metavar="EFFECT",
        action="extend",
        nargs="+",
        default=[],
        help="put these effects in",
    )
    parser.add_argument(
        "--auto", action="store_true", help="put in whatever the diagnosis finds, step by step"
    )
    parser.add_argument(
        "--effects", metavar="FILE.py", action="append", default=[], help="effects of your own"
    )
    parser.add_argument("--no-report", action="store_true", help="no pictures and no page")
    parser.add_argument("-o", "--output", metavar="OUT", required=True, help="folder to be made")
    parser.add_argument("--force", action="store_true", help="replace results of an earlier run")


def run(args: argparse.Namespace) -> int:
    """Diagnose; the folder appears whole or not at all."""
    import numpy as np

    from matstd.console import stages
    from matstd.folder import results_folder
    from twin.files.run_file import read_run
    from twin.library import load_installed_effects, load_user_effects

    load_installed_effects()
    for path in args.effects:
        load_user_effects(Path(path))
    run = read_run(args.run_file)
    with results_folder(args.output, args.force) as folder, stages() as show:
        result = _diagnosed(args, run, lambda share, doing: show(doing, int(100 * share), 100))
        _write(args, result, folder)
        if not args.no_report:
            from matstd.report_diagnosis import write_diagnosis_page

            show("report", 0, 1)
            title = Path(args.run_file).name
            write_diagnosis_page(result, folder, title, np.random.default_rng(0))
    _tell(args, result)
    return 0


def _diagnosed(
    args: argparse.Namespace, run: Run, progress: Callable[[float, str], None]
) -> Diagnosis:
    """The diagnosis, from the model file or from the ordinary model."""
    import numpy as np

    from diagnosis.diagnose import diagnose
    from diagnosis.model_file import read_model
    from twin.library import parse_effect

    saved = read_model(args.model) if args.model else None
    return diagnose(
        run,
        saved.model if saved else None,
        saved.estimates if saved else None,
        [parse_effect(name, run.touches.chain) for name in args.add],
        progress=progress,
        rng=np.random.default_rng(0),
    )


def _write(args: argparse.Namespace, result: Diagnosis, folder: Path) -> None:
    """Result, model and plans as files."""
    from diagnosis.diagnosis_file import plan_text, write_diagnosis
    from diagnosis.model_file import write_model
    from twin.files.whole import write_whole

    write_diagnosis(folder / "diagnosis.json", result)
    fit = result.fit if args.auto else result.steps[len(args.add)].fit
    write_model(folder / "model.toml", fit, Path(args.run_file).name)
    for i, plan in enumerate(result.plans, start=1):
        write_whole(folder / f"next_measurement_{i}.csv", plan_text(plan))


def _tell(args: argparse.Namespace, result: Diagnosis) -> None:
    """The verdict, the error falling, and what else should be known."""
    from rich.console import Console
    from rich.table import Column, Table

    from diagnosis.verdict import sentence
    from twin.units import UM

    console = Console(highlight=False)
    console.print(sentence(result), markup=False, style="bold")
    effect, rival = (Column(word, overflow="fold") for word in ("effect", "not told from"))
    table = Table(effect, "p", "residual µm", "held out µm", "chi²/dof", rival, box=None)
    for step in result.steps:
        rivals = step.confusion.rivals if step.confusion else ()
        table.add_row(
            step.effect.name if step.effect is not None else "model to begin with",
            f"{step.p_value:.1g}" if step.effect is not None else "",
            f"{step.fit.rms / UM:.3f}",
            f"{step.fit.test_rms / UM:.3f}",
            f"{step.fit.noise.chi2_ratio:.2f}",
            rivals[0].effect.name + (f" and {len(rivals) - 1} more" if len(rivals) > 1 else "")
            if rivals
            else "",
        )
    console.print(table)
    for remark in result.remarks:
        console.print(f"- {remark}", markup=False)
    found = len(result.steps) - 1 - len(args.add)
    if found and not args.auto:
        console.print("--auto puts what was found into model.toml; --add EFFECT one of them")
    first = "" if args.no_report else "report.html, "
    console.print(f"{args.output}: look at {first}diagnosis.json, model.toml", markup=False)
