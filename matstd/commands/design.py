"""`matstd design`: the main job, from a project file to a folder that proves itself."""

import argparse
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import replace
from pathlib import Path

from matstd.options import REPORT_FILES, add_pdf, asked_printer, print_report
from matstd.workers import add_scheduler

REFUSED = "reach-refused.png"
"""Picture of what the machine reaches, all that a refused run leaves in its folder."""


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Arguments of the command."""
    parser.add_argument("project", metavar="PROJECT.toml", help="what to design, for which machine")
    parser.add_argument("-o", "--output", metavar="OUT", required=True, help="folder to be made")
    parser.add_argument(
        "--control",
        metavar="NAME|FILE.toml",
        help="for which programs are written, instead of the project's (docs/controls.md)",
    )
    add_scheduler(parser)
    add_pdf(parser)
    parser.add_argument("--force", action="store_true", help="replace results of an earlier run")


def run(args: argparse.Namespace) -> int:
    """Design, with a bar for every stage; the folder appears whole or not at all."""
    from artefact.brief import read_project
    from matstd.console import say
    from matstd.folder import results_folder
    from matstd.from_project import dialect
    from matstd.workers import connected
    from report.words import design_lines, proof_line

    project, printed_by = read_project(args.project), asked_printer(args)
    if args.control:  # a file is seen from where the user stands, not from the project
        own = str(Path(args.control).resolve())
        project = replace(project, control=own if own.endswith(".toml") else args.control)
    dialect(project)  # a control that nobody knows is refused before any work
    with (
        results_folder(args.output, args.force, REPORT_FILES, [REFUSED]) as folder,
        _pictured(folder, args.output),
    ):
        from matstd.design import design
        from matstd.progress import stages
        from report.pages import write_design_page

        with stages() as progress, connected(args.scheduler) as workers:
            made = design(project, folder, progress, workers)
            progress("report", 0, 1)
            remarks = write_design_page(made, folder)
            print_report(folder, printed_by)
    for remark in remarks:
        say(f"- {remark}")
    verdict, *others = design_lines(made.placement)
    say(verdict, style="bold")
    for line in others:
        say(f"- {line}")
    for refusal in made.plan.refused:
        say(f"- touch dropped: {refusal}")
    for machine in made.machines:
        say(f"- {proof_line(machine.seed + 1, machine.in_workspace, machine.proof)}")
    say(f"{args.output}: look at report.html")
    return 0


@contextmanager
def _pictured(folder: Path, out: str) -> Iterator[None]:
    """Keep the picture of what is reached where reach is what stopped the run, and say where."""
    from matstd.reach import PICTURE
    from twin.errors import NotReachable

    try:
        yield
    except NotReachable as error:
        picture = Path(out) / REFUSED
        if not (folder / PICTURE).exists():
            raise
        picture.parent.mkdir(exist_ok=True)
        (folder / PICTURE).replace(picture)
        raise NotReachable(f"{error}; {picture} shows what is reached") from error
