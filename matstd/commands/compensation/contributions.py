"""`matstd contributions`: what every error adds along a part program, or at poses."""

import argparse

from matstd.commands.compensation.options import MODEL, PROGRAM, STATE
from matstd.console import say
from matstd.options import Options, output
from matstd.twin.errors import DesignError

OPTIONS: Options = {
    **MODEL,
    "--program IN": "part program (.H, .ngc)",
    **PROGRAM,
    "--loads LOADS.csv": "process forces by program line",
    "--poses POSES.csv": "axis readings, one row per pose",
    **STATE,
    **output(),
}


def run(args: argparse.Namespace) -> int:
    """Write the table and the picture; the folder appears whole or not at all."""
    from matstd.commands.compensation.job import program_options, read_job
    from matstd.report.compensation import share_lines

    if (args.program is None) == (args.poses is None):
        raise DesignError("expected one of --program FILE and --poses POSES.csv")
    machine = read_job(args)
    options = program_options(args)
    found = machine.at(args.poses) if args.poses else machine.along(args.program, options)
    found.save(args.output, args.force)
    for line in share_lines(found.whole, found.each):
        say(line)
    say(f"{args.output}: look at contributions.csv, contributions.png")
    return 0
