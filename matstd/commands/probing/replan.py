"""`matstd replan`: programs planned again for the standard's actual position, or for a visit."""

import argparse

from matstd.console import say, say_each
from matstd.options import PDF, SHEET, Options, Required, asked_printer, output
from matstd.twin.units import DEG

OPTIONS: Options = {
    "logs LOG.TXT|VISIT.csv ...": "logs of the search in OUT/setup, or of programs that missed the "
    "standard; or the touches of a planned visit (next_visit.csv of learn and diagnose)",
    "--design OUT": Required("output folder of `matstd design` or `matstd replan`"),
    "--control NAME|FILE.toml": "control that the programs are written for (default: that of the "
    "programs in OUT)",
    "--within-mm:float": "largest expected offset of the standard from its planned position, mm "
    "(default: that of the search in OUT/setup)",
    "--within-deg:float": "largest expected rotation of the standard from its planned orientation, "
    "degrees (default: as --within-mm)",
    **PDF,
    **output(),
}


def run(args: argparse.Namespace) -> int:
    """Find the place, plan, write programs and set-up sheet; the folder appears whole or not."""
    from matstd.api.replanning import OURS, planned_visit, replan
    from matstd.twin.files import results_folder

    printed_by = asked_printer(args.pdf)
    angle = None if args.within_deg is None else args.within_deg * DEG
    # a planned visit was given, and no log
    if len(args.logs) == 1 and args.logs[0].lower().endswith(".csv"):
        found = planned_visit(args.logs[0], args.design, control=args.control)
    else:
        found = replan(
            args.logs, args.design, control=args.control, distance=args.within_mm, angle=angle
        )
    for line in found.lines:
        say(line)
    with results_folder(args.output, args.force, OURS) as folder:
        found.write(folder, printed_by)
    made = found.programs
    touches = sum(program.touches for program in made.programs)
    say(f"{args.output}: {touches} touches in {len(made.programs)} programs; {SHEET}/setup.html")
    say_each(f"touch dropped: {refusal}" for one in found.stations for refusal in one.plan.refused)
    say_each(f"programs of set-up {name} were not changed" for name in found.left_alone)
    return 0
