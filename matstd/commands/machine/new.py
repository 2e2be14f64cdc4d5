"""`matstd new`: commented minimal files that the readers accept."""

from __future__ import annotations

import argparse
from importlib.resources import files
from pathlib import Path
from typing import TYPE_CHECKING

from matstd.console import say, say_each
from matstd.options import Options, seen_from
from matstd.twin.errors import BadArgument

if TYPE_CHECKING:
    from matstd.stages.proposal import Proposal

TEMPLATES = {
    "machine": "machine.toml",
    "project": "project.toml",
    "run": "run.csv",
    "effect": "effect.txt",
}
"""Kinds of files, and the template of each; that of an effect is Python, but no module of ours."""

MACHINES = (
    "trunnion",
    "swivel-45",
    "two-tables",
    "fork-portal",
    "turn-mill",
    "three-axis",
    "horizontal",
    "micro",
    "cmm",
)
"""Kinds of machines with a template of their own."""

IN_METRES = 10.0  # a table smaller than this, mm, is one in metres
WORTH_A_SET_UP = 20.0  # mm by which a second set-up must be moved to be worth its time
NEEDS_MACHINE = ("project", "run")  # kinds that name a machine file


OPTIONS: Options = {
    f"kind=|{'|'.join(TEMPLATES)}": "kind of file",
    f"--like={'|'.join(['', *MACHINES])} NAME": "for a machine: the kind that is most like yours: "
    + ", ".join(MACHINES),
    "--machine MACHINE.toml": "for a project: propose blank, probe, faces, place and workspace "
    "that suit this machine",
    "--table-mm:float SIZE ...": "with --machine: diameter of the table, or its two sides, mm "
    "(default: from the travels)",
    "-o --output FILE": "output file (default: standard output); for a project or run, a "
    "machine.toml is also written beside it if none exists",
    "--force": "overwrite an existing output",
}


def template(kind: str, like: str | None = None) -> str:
    """Text of a new file."""
    name = TEMPLATES[kind] if like is None else f"machines/{like}.toml"
    text = files("matstd").joinpath("templates", *name.split("/")).read_text(encoding="utf-8")
    return text.replace("\r\n", "\n")


def run(args: argparse.Namespace) -> int:
    """Print the file, or write it whole and say what else was written."""
    from matstd.twin.files.whole import refuse_to_overwrite

    for option, kind in (("like", "machine"), ("machine", "project")):
        if getattr(args, option) is not None and args.kind != kind:
            raise BadArgument(option, getattr(args, option), f"it with `matstd new {kind}` alone")
    _check_table(args)
    if args.output is not None:
        refuse_to_overwrite(args.output, args.force)
    if args.machine is not None:
        return _proposed(args)
    text = template(args.kind, args.like)
    if args.output is None:
        print(text, end="")
        return 0
    _written(args, text)
    return 0


def _check_table(args: argparse.Namespace) -> None:
    """Refuse a size that is none, or without a machine."""
    size = args.table_mm
    if not size:
        return
    shown = " ".join(f"{value:g}" for value in size)
    if len(size) > 2 or min(size) <= 0.0:
        raise BadArgument("table_mm", shown, "a diameter or two sides in mm")
    if max(size) < IN_METRES:
        raise BadArgument("table_mm", f"{shown} (in metres?)", "a diameter or two sides in mm")
    if args.machine is None:
        raise BadArgument("table_mm", shown, "it with --machine alone")


def _written(args: argparse.Namespace, text: str) -> None:
    """Write a template, and the machine file that it names."""
    from matstd.twin.files import write_whole

    output = Path(args.output)
    write_whole(output, text)
    say(f"{output}: edit it, then pass it to matstd")
    machine = output.parent / TEMPLATES["machine"]
    if args.kind in NEEDS_MACHINE and not machine.exists():
        write_whole(machine, template("machine"))
        say(f"{machine}: its machine file; replace the numbers by those of your machine")


def _proposed(args: argparse.Namespace) -> int:
    """Write a project that suits a machine."""
    from matstd.progress import stages
    from matstd.stages.proposal import propose
    from matstd.twin.files import write_whole

    machine, output = Path(args.machine), args.output
    folder = Path(output).parent if output is not None else Path()
    with stages() as show:
        named = seen_from(folder, machine)
        found = propose(machine, named, tuple(args.table_mm) or None, show)
    if output is None:
        print(found.text, end="")
        return 0
    write_whole(output, found.text)
    brief = found.brief
    say(
        f"{output}: base {found.base:g} x {found.base:g} mm, {brief.blank.height:g} mm high, "
        f"{brief.options.patches} faces, probe {brief.probe.length:g} mm long; seat, reach and "
        "room are checked"
    )
    say_each(brief.chain.remarks)
    say_each(_gains(found))
    return 0


def _gains(found: Proposal) -> list[str]:
    """What the table was taken for, and what a larger base or another place would gain."""
    import numpy as np

    from matstd.stages.proposal import small_travels

    size = " x ".join(f"{value:g}" for value in found.table)
    lines = [
        f"axis {name} travels {np.ptp(found.brief.chain.link(name).range):g} mm beside a table of "
        f"{min(found.table):g} mm: is axis.{name}.range of the machine in cm?"
        for name in small_travels(found.brief.chain, found.table)
    ]
    if found.is_assumed:
        lines.append(f"table taken to be {size} mm, from the travels; state it with --table-mm")
    covered = f"the base covers {100.0 * found.share_of_table(found.base):.0f} % of the table"
    if found.larger is not None:
        more = 100.0 * found.share_of_table(found.larger)
        covered += f"; a base of {found.larger:g} mm would cover {more:.0f} %"
    lines.append(covered + ": outside of what is probed the model extrapolates")
    if found.other_place > WORTH_A_SET_UP:
        reach = found.other_place + 0.5 * found.base
        lines.append(
            f"a second set-up [setup.b] with origin_mm = [{found.other_place:g}, 0, 0] would probe "
            f"out to {reach:g} mm from the middle of the table"
        )
    return lines
