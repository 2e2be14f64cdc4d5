"""`matstd contributions`: what every error adds along a part program, or at poses."""

from __future__ import annotations

import argparse
from pathlib import Path
from typing import TYPE_CHECKING

from matstd.commands.compensation.options import add_program, add_state
from matstd.twin.errors import DesignError

if TYPE_CHECKING:
    from matstd.commands.compensation.job import Job
    from matstd.twin.record import Touches

OURS = ("contributions.csv", "contributions.png")
"""Results."""


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
    parser.add_argument("--program", metavar="IN", help="part program (.H, .ngc)")
    add_program(parser)
    parser.add_argument("--loads", metavar="LOADS.csv", help="process forces by program line")
    parser.add_argument("--poses", metavar="POSES.csv", help="axis readings, one row per pose")
    add_state(parser)
    parser.add_argument("-o", "--output", metavar="OUT", required=True, help="output folder")
    parser.add_argument("--force", action="store_true", help="replace results of an earlier run")


def run(args: argparse.Namespace) -> int:
    """Write the table and the picture; the folder appears whole or not at all."""
    from matstd.commands.compensation.job import read_job
    from matstd.compensation.field import contributions, deviation
    from matstd.compensation.programs import write_shares
    from matstd.console import say
    from matstd.report.compensation import draw_shares_along, share_lines
    from matstd.report.style import save
    from matstd.twin.files import results_folder

    if (args.program is None) == (args.poses is None):
        raise DesignError("expected one of --program FILE and --poses POSES.csv")
    job = read_job(args)
    touches = _poses(args, job)
    with results_folder(args.output, args.force, OURS) as folder:
        whole = deviation(job.errors, touches) - job.datum.deviation(job.errors)
        shares = contributions(job.errors, touches, job.datum)
        write_shares(folder / "contributions.csv", touches, whole, shares)
        save(draw_shares_along(touches.time, whole, shares), folder / "contributions.png")
    for line in share_lines(whole, shares):
        say(line)
    say(f"{args.output}: look at contributions.csv, contributions.png")
    return 0


def _poses(args: argparse.Namespace, job: Job) -> Touches:
    """Poses that the program passes, or those of the file."""
    from dataclasses import replace

    from matstd.commands.compensation.job import by_tool
    from matstd.compensation.part_programs import Frame, read_loads, read_part_program
    from matstd.compensation.programs import passed
    from matstd.twin.files import read_poses

    if args.program is not None:
        frame = Frame(job.errors.chain, job.datum)
        tools = by_tool("--tool", args.tool), by_tool("--tool-radius", args.tool_radius)
        program = read_part_program(Path(args.program), frame, *tools, args.pass_m, args.tcp_m)
        loads = read_loads(args.loads) if args.loads else ()
        return passed(replace(program, loads=loads), job.errors)
    q, length = read_poses(args.poses, job.errors.chain)
    return job.errors.touches(q, length)
