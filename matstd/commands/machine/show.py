"""`matstd show`: one page on which a machine moves, with its errors and a program."""

import argparse

from matstd.commands.compensation.options import DATUM, DRIVEN, PROGRAM
from matstd.console import say, say_each
from matstd.options import EFFECTS, ONE_OF, Options, output
from matstd.twin.errors import BadArgument
from matstd.twin.units import USUAL_TOOL_LENGTH

OPTIONS: Options = {
    "machine MACHINE.toml": "machine file",
    ONE_OF: {
        "--errors ERRORS.toml": "errors of the machine",
        "--model MODEL.toml": "model of a diagnosis of this machine",
    },
    "--program PROGRAM ...": "a part program (.H, .ngc), or probing programs in their order",
    "--standard STANDARD.toml": "standard that the probing programs touch; also shows the "
    "clearance of the probe",
    f"--tool-length={USUAL_TOOL_LENGTH} MM": "length of the tool, from the spindle gauge point to "
    "the tip (160)",
    **DATUM,
    "--control=itnc530 NAME|FILE.toml": "control that probing programs are written for; needed for "
    "your own dialect (itnc530)",
    **PROGRAM,
    "--loads LOADS.csv": "process forces by program line",
    **DRIVEN,
    **EFFECTS,
    **output("PAGE.html"),
}


def run(args: argparse.Namespace) -> int:
    """Write the page."""
    from matstd.api.showing import show
    from matstd.commands.compensation.job import machine_state, named_readings, program_options
    from matstd.effect_kinds import register_effects
    from matstd.progress import stages
    from matstd.report.machine import shown_lines
    from matstd.twin.files.whole import refuse_to_overwrite

    if not args.output.endswith(".html"):
        raise BadArgument("output", args.output, "the name of a page, which ends in .html")
    refuse_to_overwrite(args.output, args.force)
    register_effects(*args.effects)
    with stages() as progress:
        page = show(
            args.machine,
            args.errors,
            model=args.model,
            program=args.program,
            standard=args.standard,
            tool_length=args.tool_length,
            datum=named_readings("--datum", args.datum),
            options=program_options(args),
            control=args.control,
            state=machine_state(args),
            add=args.add,
            progress=progress,
        )
        page.save(args.output, args.force)
    for line in shown_lines(page.shown):
        say(line)
    say_each(page.shown.chain.remarks)
    say(f"{args.output}: open it in a browser; it loads nothing")
    return 0
