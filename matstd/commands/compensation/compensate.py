"""`matstd compensate`: the identified model goes back to the control."""

from __future__ import annotations

import argparse
import shutil
from pathlib import Path
from typing import TYPE_CHECKING

from matstd.commands.compensation.options import add_program, add_state
from matstd.twin.errors import DesignError

if TYPE_CHECKING:
    from matstd.commands.compensation.job import Job
    from matstd.compensation.tables import Played

OURS = ("*/*", "report.html", "tables.xlsx", "tables/*.csv", "pictures/*.png", "compensation.json")
"""Results that not every compensation leaves."""


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Arguments of the command."""
    parser.add_argument(
        "model", metavar="MODEL.toml", help="model of a diagnosis, or a machine file with --errors"
    )
    parser.add_argument(
        "--errors",
        metavar="ERRORS.toml",
        help="errors of the machine, if MODEL.toml is a machine file",
    )
    parser.add_argument(
        "--tables", metavar="DIR", help="write compensation tables of the controls to this folder"
    )
    parser.add_argument("--program", metavar="IN", help="part program to compensate (.H, .ngc)")
    parser.add_argument("-o", "--output", metavar="OUT", help="compensated program")
    parser.add_argument(
        "--tolerance",
        metavar="UM",
        type=float,
        help="largest distance between a path and the line segments that replace it, µm (1)",
    )
    add_program(parser)
    parser.add_argument(
        "--loads",
        metavar="LOADS.csv",
        help="process forces by program line, with --program (--load applies to the other lines)",
    )
    parser.add_argument(
        "--control",
        metavar="NAME",
        action="append",
        default=[],
        help="write only the tables of this control: iso230, sinumerik, linuxcnc, heidenhain",
    )
    parser.add_argument(
        "--opposite",
        metavar="NAME",
        action="append",
        default=[],
        help="reverse the sign of the values in the tables of this control",
    )
    add_state(parser)
    parser.add_argument("--force", action="store_true", help="replace results of an earlier run")


def run(args: argparse.Namespace) -> int:
    """Write what is asked for; a folder appears whole or not at all."""
    from matstd.commands.compensation.job import read_job

    if (args.tables is None) == (args.program is None):
        raise DesignError("expected one of --tables DIR and --program FILE -o OUT")
    if args.loads and args.program is None:
        raise DesignError("expected --program with --loads")
    if (args.program is None) != (args.output is None):
        raise DesignError("expected -o OUT with --program, and only there")
    job = read_job(args)
    return _tables(args, job) if args.program is None else _program(args, job)


def _program(args: argparse.Namespace, job: Job) -> int:
    """A compensated program, its points as a table, its picture."""
    from dataclasses import replace

    from matstd.commands.compensation.job import by_tool
    from matstd.compensation.part_programs import Frame, read_loads, read_part_program
    from matstd.compensation.programs import (
        TOLERANCE,
        compensated,
        write_program_result,
        write_trajectory,
    )
    from matstd.console import say
    from matstd.report.compensation import draw_program, program_lines
    from matstd.report.style import save
    from matstd.twin.files import refuse_to_overwrite, write_whole
    from matstd.twin.units import UM

    output = Path(args.output)
    beside = [output.with_suffix(ending) for ending in (".csv", ".png", ".json")]
    for path in (output, *beside):
        refuse_to_overwrite(path, args.force)
    frame = Frame(job.errors.chain, job.datum)
    program = read_part_program(
        args.program,
        frame,
        by_tool("--tool", args.tool),
        by_tool("--tool-radius", args.tool_radius),
        args.pass_m,
        args.tcp_m,
    )
    if args.loads:
        program = replace(program, loads=read_loads(args.loads))
    tolerance = TOLERANCE if args.tolerance is None else args.tolerance * UM
    done = compensated(program, job.errors, job.header(1), tolerance)
    write_whole(output, done.text)  # the first: where another run was faster, it is what is kept
    write_trajectory(beside[0], done)
    save(draw_program(done), beside[1])
    write_program_result(beside[2], done)
    for line, is_first in program_lines(output.name, done):
        say(line, style="bold" if is_first else None)
    say(f"{output}: look at {', '.join(path.name for path in beside)} beside it")
    return 0


def _tables(args: argparse.Namespace, job: Job) -> int:
    """Tables of every control, read back and played."""
    from matstd.compensation.tables import (
        FORMATS,
        Harmful,
        play_tables,
        refuse_harmful,
        write_table_results,
        write_tables,
    )
    from matstd.progress import stages
    from matstd.report.compensation import write_compensation_page
    from matstd.twin.files import results_folder

    names = _controls(args.control) or list(FORMATS)
    opposite = _controls(args.opposite)
    done: list[Played] = []
    harmful: list[str] = []
    with results_folder(args.tables, args.force, OURS) as folder, stages() as show:
        for k, name in enumerate(names):
            show("tables", k, len(names))
            place, head = folder / name, job.header(-1 if name in opposite else 1)
            words = FORMATS[name], place, job.errors, job.datum, head, job.poses
            write_tables(*words)
            played = play_tables(*words)
            try:
                refuse_harmful(played)
                done.append(played)
            except Harmful as refusal:
                if args.control or len(harmful) + 1 == len(names):
                    raise
                harmful.append(str(refusal))
                shutil.rmtree(place, ignore_errors=True)
        head = job.header(1)
        write_table_results(folder / "compensation.json", job.errors, head, done)
        write_compensation_page(folder, job.errors, head, done, Path(args.model).name)
    _report(args, done, harmful)
    return 0


def _controls(names: list[str]) -> list[str]:
    from matstd.compensation.tables import FORMATS

    for name in names:
        if name not in FORMATS:
            raise DesignError(f"control {name}: expected one of {', '.join(FORMATS)}")
    return list(dict.fromkeys(names))


def _report(args: argparse.Namespace, done: list[Played], harmful: list[str]) -> None:
    """Every control in a line, what it cannot hold in another, then the tables not written."""
    from matstd.console import say
    from matstd.report.compensation import table_lines

    for played in done:
        for line, is_first in table_lines(played):
            say(line, style="bold" if is_first else None)
    for refusal in harmful:
        say(f"not written: {refusal}", style="bold")
    say(f"{args.tables}: look at report.html, compensation.json")
