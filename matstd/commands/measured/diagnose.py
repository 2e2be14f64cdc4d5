"""`matstd diagnose`: which effect the model lacks, and how far the error falls with it."""

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
    from collections.abc import Callable

    from matstd.diagnosis.answer import Diagnosis, Step
    from matstd.diagnosis.files import SavedModel
    from matstd.twin.record import Run

OURS = ("next_measurement_*.csv", FOUND, "pictures/*.png", *REPORT_FILES)
"""Results that not every diagnosis leaves."""


WIDE = 40
"""Letters of a cell of words, so that the table of figures fits beside them."""


LISTS = (
    (
        "--hold-out",
        "RUN",
        "exclude these runs from the fit (only their set-ups are fitted) and report "
        "how well the others predict them",
    ),
    ("--add", "EFFECT", "add these effects to the model"),
    ("--only", "KIND", "search only for effects of these kinds or names"),
    ("--without", "KIND", "do not search for effects of these kinds or names"),
)
"""Options with one or more words, which may be given more than once."""


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Arguments of the command."""
    parser.add_argument(
        "run_files",
        metavar="RUN.csv",
        nargs="+",
        help="measurements; several runs of one machine (days, set-ups, standards) in "
        "order of time",
    )
    for option, word, meaning in LISTS:
        parser.add_argument(
            option, metavar=word, action="extend", nargs="+", default=[], help=meaning
        )
    parser.add_argument(
        "--auto",
        action="store_true",
        help="add every effect that the diagnosis finds, step by step",
    )
    add_measured(parser, "starting model of the diagnosis (default: the ordinary geometric model)")


def run(args: argparse.Namespace) -> int:
    """Diagnose; the folder appears whole or not at all."""
    from matstd.inputs import read_inputs, with_pitches
    from matstd.twin.words import deviations_in

    same = "so that its estimates are made anew: no touch counts twice"
    run, saved = read_inputs(args.run_files, model_file(args), args.effects, same, args.hold_out)
    run = with_pitches(run, args.pitch)
    with deviations_in(run.touches.deviation_unit):
        return _made(args, run, saved)


def _made(args: argparse.Namespace, run: Run, saved: SavedModel | None) -> int:
    """The diagnosis as files and in words."""
    import numpy as np

    from matstd.progress import stages, turns

    printed_by = asked_printer(args)
    with results_folder(args.output, args.force, OURS) as folder, stages() as show:
        result = _diagnosed(args, run, saved, turns(show))
        _write(args, result, saved, folder)
        found = write_found_arm(folder, result.fit, _title(args))
        if not args.no_report:
            from matstd.report.pages import write_diagnosis_page

            show("report", 0, 1)
            title = _title(args)
            write_diagnosis_page(result, folder, title, np.random.default_rng(0))
            print_report(folder, printed_by)
    _tell(args, result, found)
    return 0


def _title(args: argparse.Namespace) -> str:
    return ", ".join(Path(path).name for path in args.run_files)


def _diagnosed(
    args: argparse.Namespace,
    run: Run,
    saved: SavedModel | None,
    progress: Callable[[float, str], None],
) -> Diagnosis:
    """The diagnosis, from the model file or from the ordinary model."""
    import numpy as np

    from matstd.diagnosis.answer import diagnose
    from matstd.inputs import candidates, is_learnt_from, named_effects

    start = saved.model if saved else first_model(args, run.touches.chain)
    known = saved.estimates if saved and not is_learnt_from(saved, run) else None
    added = named_effects(args.add, start.effects, run)
    found = candidates(args.only, args.without, run)
    rng = np.random.default_rng(0)
    return diagnose(run, start, known, added, found, progress, rng)


def _write(
    args: argparse.Namespace, result: Diagnosis, saved: SavedModel | None, folder: Path
) -> None:
    """Result, model and plans as files."""
    from matstd.diagnosis.files import plan_text, write_diagnosis, write_model
    from matstd.inputs import is_learnt_from
    from matstd.report.words import remark_sentence
    from matstd.twin.files import write_whole
    from matstd.twin.versions import versions

    sentences = [remark_sentence(r) for r in result.remarks]
    write_diagnosis(folder / "diagnosis.json", result, sentences)
    fit = result.fit if args.auto else result.steps[len(args.add)].fit
    before = saved if saved and not is_learnt_from(saved, result.run) else None
    made_with = f"material-standard {versions()['material-standard']}"
    promised = result.choice.best.error if fit is result.fit and result.choice else None
    name = _title(args)
    told = {s.effect.name: s.reported for s in result.steps if s.effect is not None}
    write_model(folder / "model.toml", fit, name, before, made_with, promised, told)
    for i, plan in enumerate(result.plans, start=1):
        write_whole(folder / f"next_measurement_{i}.csv", plan_text(plan))


def _tell(args: argparse.Namespace, result: Diagnosis, found: str) -> None:
    """The verdict, the error falling, what was found to copy, and what else should be known."""
    from rich.table import Column, Table

    from matstd.console import console, say
    from matstd.report.effects import plan_words, rival_words
    from matstd.report.geometry import console_lines
    from matstd.report.words import remark_sentence, scanned_sentence, verdict_sentence
    from matstd.twin.words import in_own_unit

    say(f"{result.verdict.value}: {verdict_sentence(result)}", style="bold")
    right = ("p", "fitted µm", "held out µm", "chi²/dof")
    numbers = [Column(in_own_unit(word), justify="right", no_wrap=True) for word in right]
    words = [Column(word, overflow="fold", max_width=WIDE) for word in ("effect", "size")]
    table = Table(*words, *numbers, box=None)
    for step in result.steps:
        table.add_row(*_row(step))
    console().print(table)
    for step in result.steps:
        if step.effect is not None and (rivals := rival_words(step)):
            say(f"- {rivals}")
    known = result.run.touches, result.geometry, result.faults, result.trend
    for line, is_first in console_lines(*known):
        say(f"- {line}", style="bold" if is_first else None)
    told = [
        found,
        *(remark_sentence(r) for r in result.remarks),
        scanned_sentence(result.detectable),
    ]
    for line in filter(None, told):
        say(f"- {line}")
    if any(not s.is_named for s in result.steps[1:]) and not args.auto:
        say(
            "- model.toml holds only effects you named; --auto adds what was found, "
            "--add NAME one of them"
        )
    for i, plan in enumerate(result.plans, start=1):
        say(f"- next_measurement_{i}.csv would distinguish {plan_words(plan)}")
    first = "" if args.no_report else "report.html, "
    say(f"{args.output}: look at {first}diagnosis.json, model.toml")


def _row(step: Step) -> tuple[str, ...]:
    """One step of the table: what was added, how large it is, and how far the error fell."""
    from rich.markup import escape

    from matstd.report.effects import effect_cell
    from matstd.report.numbers import digits
    from matstd.report.words import values
    from matstd.twin.units import UM

    first = enumerate(values(step)[:2])
    return (
        escape("\n".join(filter(None, effect_cell(step)))) if step.effect else "starting model",
        ", ".join(f"{name} {value}" if i else value for i, (name, value) in first),
        f"{step.p_value:.0e}" if step.effect is not None else "",
        f"{step.fit.rms / UM:.3f}",
        f"{step.fit.test_rms / UM:.3f}",
        digits(step.fit.noise.chi2_ratio),
    )
