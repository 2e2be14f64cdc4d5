"""`matstd new`: commented minimal files that the readers accept."""

import argparse
from importlib.resources import files
from pathlib import Path

TEMPLATES = {
    "machine": "machine.toml",
    "project": "project.toml",
    "run": "run.csv",
    "effect": "effect.txt",
}
"""Kinds of files, and the template of each; that of an effect is Python, but no module of ours."""

NEEDS_MACHINE = ("project", "run")
"""Kinds that name a machine file."""


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Arguments of the command."""
    parser.add_argument("kind", choices=TEMPLATES, help="kind of file")
    parser.add_argument(
        "-o",
        "--output",
        metavar="FILE",
        help="output file (default: standard output); for a project or run, a machine.toml "
        "is also written beside it if none exists",
    )
    parser.add_argument("--force", action="store_true", help="overwrite an existing output")


def template(kind: str) -> str:
    """Text of a new file."""
    text = files("matstd").joinpath("templates", TEMPLATES[kind]).read_text(encoding="utf-8")
    return text.replace("\r\n", "\n")


def run(args: argparse.Namespace) -> int:
    """Print the file, or write it whole and say what else was written."""
    if args.output is None:
        print(template(args.kind), end="")
        return 0
    from matstd.console import say
    from matstd.twin.files import refuse_to_overwrite, write_whole

    output = Path(args.output)
    refuse_to_overwrite(output, args.force)
    write_whole(output, template(args.kind))
    say(f"{output}: edit it, then pass it to matstd")
    machine = output.parent / TEMPLATES["machine"]
    if args.kind in NEEDS_MACHINE and not machine.exists():
        write_whole(machine, template("machine"))
        say(f"{machine}: its machine file; replace the numbers by those of your machine")
    return 0
