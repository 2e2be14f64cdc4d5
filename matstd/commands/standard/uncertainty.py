"""`matstd uncertainty`: of a user's measuring task, from visits to calibrated faces."""

import argparse

from matstd.console import say, say_each
from matstd.options import EFFECTS, Options, Required, output

OPTIONS: Options = {
    "run_files RUN.csv ...": "two or more runs on one standard",
    "--standard STANDARD.toml": Required("calibrated standard that was measured"),
    "--task TASK.toml": "measuring task on the workpieces (default: every feature that was touched "
    "on the faces)",
    "--model MODEL.toml": "model of an earlier diagnosis; results are corrected with it",
    "--page PAGE.html": "also write a report page, with its tables beside it",
    **EFFECTS,
    **output("OUT.json"),
}


def run(args: argparse.Namespace) -> int:
    """Evaluate; the result is written whole or not at all."""
    from matstd.api.standards import uncertainty
    from matstd.effect_kinds import register_effects
    from matstd.twin.files.whole import refuse_to_overwrite

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
