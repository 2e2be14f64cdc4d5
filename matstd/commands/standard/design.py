"""`matstd design`: the main job, from a project file to a folder that proves itself."""

from __future__ import annotations

import argparse
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING

from matstd.options import (
    REPORT_FILES,
    SHEET,
    SHEET_FILES,
    add_output,
    add_pdf,
    asked_printer,
    print_report,
)
from matstd.workers import add_scheduler

if TYPE_CHECKING:
    from matstd.artefact.brief import Project
    from matstd.twin.errors import DesignError

REFUSED = "reach-refused.png"
"""Picture of what the machine reaches, all that a refused run leaves in its folder."""

NO_ROOM = "room-refused.png"
"""Likewise of the patches that fit side by side."""

_KEYS = {
    "smallest concave radius": "limits.min_concave_radius_mm (smaller)",
    "slope": "limits.max_slope_deg (larger)",
    "height": "blank.height_mm (larger)",
    "room for the ball before": "limits.gap_mm or probe.radius_mm (smaller)",
    "distance of the stem from": "limits.gap_mm or probe.radius_mm (smaller)",
    "mass": "limits.max_mass_kg (larger)",
    "slots": "limits.slot_pitch_mm (smaller, or 0)",
}
"""What may be changed where a constraint binds."""

_ALWAYS, _LIGHTER = "blank.base_mm and blank.height_mm (larger)", "blank.base_mm (smaller)"

_NOTHING = (
    "no change of standard.patches, limits or blank.base_mm alone would do of those that were tried"
)


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Arguments of the command."""
    parser.add_argument(
        "project", metavar="PROJECT.toml", help="project file: machine, blank, workspace, control"
    )
    parser.add_argument(
        "--control",
        metavar="NAME|FILE.toml",
        help="control that the programs are written for (default: the project's; see "
        "docs/controls.md)",
    )
    add_scheduler(parser)
    add_pdf(parser)
    add_output(parser)


def run(args: argparse.Namespace) -> int:
    """Design, with a bar for every stage; the folder appears whole or not at all."""
    from matstd.artefact.brief import read_project
    from matstd.artefact.reach import standing_remarks
    from matstd.console import say, say_assumed, say_each
    from matstd.report.task import modulus_words, task_lines
    from matstd.report.words import design_lines, proof_line
    from matstd.stages.from_project import dialects, feeds
    from matstd.twin.files import results_folder
    from matstd.workers import connected

    project, printed_by = read_project(args.project), asked_printer(args)
    if args.control:  # a file is seen from where the user stands, not from the project
        own = str(Path(args.control).resolve())
        project = replace(project, control=own if own.endswith(".toml") else args.control)
    dialects(project)  # a control that nobody knows is refused before any work
    say_assumed(project.chain)
    say_each(project.remarks)
    say_each(standing_remarks(project.chain, project.setup.T_table_artefact))
    leftovers = (*REPORT_FILES, *SHEET_FILES)
    with (
        results_folder(args.output, args.force, leftovers, [REFUSED, NO_ROOM]) as folder,
        refusals(project, folder, args.output),
    ):
        from matstd.progress import stages
        from matstd.report.pages import write_design_page
        from matstd.stages.design import design
        from matstd.stages.sheets import write_sheets

        with stages() as progress, connected(args.scheduler) as workers:
            made = design(project, folder, progress, workers)
            progress("report", 0, 1)
            remarks = write_design_page(made, folder)
            print_report(folder, printed_by)
            raised = project.workshop.dry_run_mm
            write_sheets(folder / SHEET, made.stations, feeds(project), printed_by, raised)
    say_each(remarks)
    verdict, *others = design_lines(made.placement, project.workspace)
    say(verdict, style="bold")
    say_each(others)
    # a pose is visited twice
    dropped = dict.fromkeys(str(r) for one in made.stations for r in one.plan.refused)
    say_each(f"touch dropped: {refusal}" for refusal in dropped)
    tools = {one.dialect.tool for one in made.stations}
    say_each(
        f"tool {probe.tool} has no program: those before it make every touch that it could"
        for probe in project.further_probes
        if probe.tool not in tools
    )
    say_each(proof_line(m.seed + 1, m.in_workspace, m.proof, m.fit) for m in made.machines)
    say_each([f"Young's modulus: {modulus_words(made.making.material)}"])
    say_each(task_lines(made.budgets, project.task.tolerance, made.visits))
    say(f"{args.output}: look at report.html; {SHEET}/setup.html goes with the programs")
    return 0


@contextmanager
def refusals(project: Project, folder: Path, out: str) -> Iterator[None]:
    """Make whatever stops a design one line that helps.

    Args:
        project: What is designed.
        folder: In which it is; the picture of what is reached lies there.
        out: Where a picture goes of what stops it.
    """
    from matstd.stages import reach, space
    from matstd.twin.errors import NotBuildable, NotReachable

    try:
        yield
    except NotBuildable as error:
        told = f"{project.path}: {error}; {_what_helps(error)}"
        seen = _left(folder / space.PICTURE, Path(out) / NO_ROOM, "what fits")
        raise NotBuildable(told + seen) from error
    except NotReachable as error:
        told = str(error)
        if not told.startswith(str(project.path)):
            told = f"{project.path}: {told}; change workspace, setup or probe.length_mm"
        seen = _left(folder / reach.PICTURE, Path(out) / REFUSED, "what is reached")
        raise NotReachable(told + seen) from error


def _left(picture: Path, there: Path, shows: str) -> str:
    """Leave a picture to the user if there is one, and say so."""
    if not picture.exists():
        return ""
    there.parent.mkdir(exist_ok=True)
    picture.replace(there)
    return f"; {there} shows {shows}"


def _what_helps(error: DesignError) -> str:
    """Changes that were tried and would do, or keys of the project file, the likeliest first."""
    from matstd.artefact.brief import FEWEST_PATCHES

    if error.facts.keys() & {"conformity", "exit_code"}:
        return "change seed: the fault is the tool's own, not the project's"
    fitting, binding = error.facts.get("fitting"), error.facts.get("binding")
    wishes = error.facts.get("wishes")
    if isinstance(wishes, list):
        return f"{' or '.join(wishes)} would do" if wishes else _NOTHING
    keys = []
    if isinstance(fitting, int):
        if fitting >= FEWEST_PATCHES:
            keys.append(f"standard.patches (to {fitting})")
        keys.append(_KEYS["room for the ball before"])
    keys += [_KEYS.get(name, _ALWAYS) for name in binding] if isinstance(binding, list) else []
    last = _LIGHTER if binding == ["mass"] else _ALWAYS
    return f"change {' or '.join(dict.fromkeys([*keys, last]))}"
