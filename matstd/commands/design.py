"""`matstd design`: the main job, from a project file to a folder that proves itself."""

import argparse
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

from matstd.workers import add_scheduler

REFUSED = "reach-refused.png"
"""Picture of what the machine reaches, all that a refused run leaves in its folder."""


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Arguments of the command."""
    parser.add_argument("project", metavar="PROJECT.toml", help="what to design, for which machine")
    parser.add_argument("-o", "--output", metavar="OUT", required=True, help="folder to be made")
    add_scheduler(parser)
    parser.add_argument("--force", action="store_true", help="replace results of an earlier run")


def run(args: argparse.Namespace) -> int:
    """Design, with a bar for every stage; the folder appears whole or not at all."""
    from artefact.brief import read_project
    from matstd.folder import results_folder
    from matstd.workers import connected

    project = read_project(args.project)
    with (
        results_folder(args.output, args.force, [REFUSED]) as folder,
        _pictured(folder, args.output),
    ):
        from matstd.console import stages
        from matstd.design import design
        from report.pages import write_design_page
        from report.words import identification_sentence

        with stages() as progress, connected(args.scheduler) as workers:
            made = design(project, folder, progress, workers)
            progress("report", 0, 1)
            remarks = write_design_page(made, folder)
    for remark in remarks:
        print(remark)
    if sentence := identification_sentence(made.placement):
        print(sentence)
    for machine in made.machines:
        proof = machine.proof
        print(
            f"machine {machine.seed + 1}: volumetric error {proof.rms_before * 1e3:.1f} µm rms, "
            f"not predicted {proof.rms_after * 1e3:.2f} µm (stated uncertainty "
            f"{proof.rms_u * 1e3:.2f} µm): {proof.factor:.0f} times smaller"
        )
    print(f"{args.output}: look at report.html")
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
