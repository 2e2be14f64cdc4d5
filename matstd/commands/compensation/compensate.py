"""`matstd compensate`: the identified model goes back to the control."""

from __future__ import annotations

import argparse
from pathlib import Path
from typing import TYPE_CHECKING

from matstd.commands.compensation.options import MODEL, PROGRAM, STATE
from matstd.console import say, say_each
from matstd.options import Options
from matstd.twin.errors import DesignError
from matstd.twin.units import UM

if TYPE_CHECKING:
    from matstd.api.compensating import Compensation


OPTIONS: Options = {
    **MODEL,
    "--tables DIR": "write compensation tables of the controls to this folder",
    "--program IN": "part program to compensate (.H, .ngc)",
    "-o --output OUT": "compensated program",
    "--tolerance:float UM": "largest distance between a path and the line segments that replace "
    "it, µm (1)",
    **PROGRAM,
    "--loads LOADS.csv": "process forces by program line, with --program (--load applies to the "
    "other lines)",
    "--control:list NAME": "write only the tables of this control: iso230, sinumerik, linuxcnc, "
    "heidenhain",
    "--opposite:list NAME": "reverse the sign of the values in the tables of this control",
    **STATE,
    "--force": "replace results of an earlier run",
}


def run(args: argparse.Namespace) -> int:
    """Write what is asked for; a folder appears whole or not at all."""
    from matstd.commands.compensation.job import read_job

    if (args.tables is None) == (args.program is None):
        raise DesignError("expected one of --tables DIR and --program FILE -o OUT")
    if args.loads and args.program is None:
        raise DesignError("expected --program with --loads")
    if (args.program is None) != (args.output is None):
        raise DesignError("expected -o OUT with --program, and only there")
    machine = read_job(args)
    return _tables(args, machine) if args.program is None else _program(args, machine)


def _program(args: argparse.Namespace, machine: Compensation) -> int:
    """A compensated program, its points as a table, its picture."""
    from matstd.api.compensating import beside_program
    from matstd.commands.compensation.job import program_options
    from matstd.compensation.programs import TOLERANCE
    from matstd.report.compensation import program_lines

    output, options = Path(args.output), program_options(args)
    tolerance = TOLERANCE if args.tolerance is None else args.tolerance * UM
    done = machine.program(
        args.program, output, tolerance=tolerance, options=options, force=args.force
    )
    heading, *below = program_lines(output.name, done)
    say(heading, style="bold")
    say_each(below)
    names = ", ".join(path.name for path in beside_program(output))
    say(f"{output}: look at {names} beside it")
    return 0


def _tables(args: argparse.Namespace, machine: Compensation) -> int:
    """Every control in a line, what it cannot hold in another, then the tables not written."""
    from matstd.progress import stages
    from matstd.report.compensation import table_lines

    with stages() as show:
        found = machine.tables(
            args.tables, args.control, opposite=args.opposite, force=args.force, progress=show
        )
    for played in found.done:
        heading, *below = table_lines(played)
        say(heading, style="bold")
        say_each(below)
    for refusal in found.refused:
        say(f"not written: {refusal}", style="bold")
    say(f"{args.tables}: look at report.html, compensation.json")
    return 0
