"""`matstd uncertainty`: of a user's measuring task, from visits to calibrated faces."""

from __future__ import annotations

import argparse

from matstd.console import say, say_each
from matstd.options import add_effects, add_options, add_output


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
    add_options(
        parser,
        {
            "--task TASK.toml": "measuring task on the workpieces (default: every feature that "
            "was touched on the faces)",
            "--model MODEL.toml": "model of an earlier diagnosis; results are corrected with it",
            "--page PAGE.html": "also write a report page, with its tables beside it",
        },
    )
    add_effects(parser)
    add_output(parser, "OUT.json")


def run(args: argparse.Namespace) -> int:
    """Evaluate; the result is written whole or not at all."""
    from matstd.api.standards import uncertainty
    from matstd.effect_kinds import register_effects
    from matstd.twin.files import refuse_to_overwrite

    refuse_to_overwrite(args.output, args.force)
    if args.page:
        refuse_to_overwrite(args.page, args.force)
    register_effects(*args.effects)
    found = uncertainty(args.run_files, args.standard, args.task, args.model)
    found.save(args.output)
    if args.page:
        found.page(args.page)
    say(f"{args.output}: {found.task.name}: {found.sentence}")
    say_each([*found.lines, *found.remarks])
    return 0
