"""`matstd uncertainty`: of a user's measuring task, from visits to calibrated faces."""

from __future__ import annotations

import argparse
from typing import TYPE_CHECKING

from matstd.options import add_effects, add_output, load_effects

if TYPE_CHECKING:
    from matstd.diagnosis.fit import Prior
    from matstd.twin.model import Model


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Arguments of the command."""
    parser.add_argument(
        "run_files", metavar="RUN.csv", nargs="+", help="two or more runs on one standard"
    )
    parser.add_argument(
        "--standard",
        metavar="STANDARD.toml",
        required=True,
        help="calibrated standard that was measured",
    )
    parser.add_argument(
        "--task",
        metavar="TASK.toml",
        help="measuring task on the workpieces (default: every feature that was touched on "
        "the faces)",
    )
    parser.add_argument(
        "--model",
        metavar="MODEL.toml",
        help="model of an earlier diagnosis; results are corrected with it",
    )
    parser.add_argument(
        "--page", metavar="PAGE.html", help="also write a report page, with its tables beside it"
    )
    add_effects(parser)
    add_output(parser, "OUT.json")


def run(args: argparse.Namespace) -> int:
    """Evaluate; the result is written whole or not at all."""
    from matstd.artefact.body import read_standard
    from matstd.artefact.brief import Task, read_task
    from matstd.artefact.certify import check_places
    from matstd.artefact.worth import Calibration
    from matstd.console import say, say_each
    from matstd.diagnosis.files import check_machine, read_model, write_uncertainty
    from matstd.inputs import is_learnt_from
    from matstd.report.pages import write_uncertainty_page
    from matstd.report.task import measured_sentence, task_lines
    from matstd.report.words import remark_sentence
    from matstd.stages.budgets import PLAIN, budgets
    from matstd.twin.files import read_run, refuse_to_overwrite

    refuse_to_overwrite(args.output, args.force)
    if args.page:
        refuse_to_overwrite(args.page, args.force)
    load_effects(args.effects)
    task = read_task(args.task) if args.task else Task()
    standard = read_standard(args.standard)
    runs = [read_run(path) for path in args.run_files]
    check_visits(args.run_files, [one.fingerprint for one in runs])
    for path, one in zip(args.run_files, runs, strict=True):
        check_places(standard, one.touches, path)
    models: dict[str, tuple[Model, Prior] | None] = {PLAIN: None}
    remarks = [
        f"{p}: {r}" for p, one in zip(args.run_files, runs, strict=True) for r in one.remarks
    ]
    remarks += standard.remarks
    if args.model:
        saved = read_model(args.model, runs=runs)
        remarks += [remark_sentence(one) for one in saved.left_out]
        for one in runs:
            check_machine(saved, one.touches.chain, args.model)
        models[f"with {args.model}"] = saved.model, saved.estimates
        remarks += [
            f"{args.model} has learnt from {path}: a visit proves more where it had no part in it"
            for path, one in zip(args.run_files, runs, strict=True)
            if is_learnt_from(saved, one)
        ]
    found, visits = budgets(runs, standard, Calibration(), task, models)
    write_uncertainty(args.output, task.name, found, task.tolerance)
    measured = measured_sentence(next(iter(found.values())))
    lines = task_lines(found, task.tolerance, visits)
    if args.page:
        names = [(path, len(one)) for path, one in zip(args.run_files, runs, strict=True)]
        write_uncertainty_page(
            args.page, task.name, standard.name, measured, found, lines, names, remarks
        )
    say(f"{args.output}: {task.name}: {measured}")
    say_each([*lines, *remarks])
    return 0


def check_visits(files: list[str], prints: list[str]) -> None:
    """Refuse one measurement that is given twice; raises DesignError."""
    from matstd.twin.errors import DesignError

    for k, print_ in enumerate(prints):
        if print_ in prints[:k]:
            raise DesignError(
                f"{files[k]}: the same measurements as {files[prints.index(print_)]}, expected "
                "every visit once"
            )
