"""`matstd sensitivity`: S at given poses, or a whole study of a project with its Monte Carlo."""

import argparse
from pathlib import Path

from matstd.console import say_each
from matstd.options import PDF, Options, Required
from matstd.twin.errors import BadFile, DesignError
from matstd.workers import SCHEDULER

_STUDY_ONLY = ("draws", "digits", "tolerance_um", "scheduler", "pdf")


ABOUT = (
    "With a machine and poses: write the sensitivity to every error parameter at every pose to a "
    "CSV file. With a project: write maps, trajectories and a Monte Carlo study of random machines "
    "to a folder."
)

OPTIONS: Options = {
    "source MACHINE.toml|PROJECT.toml": "machine file, or project file",
    "poses [POSES.csv]": "axis readings, one row per pose (with a machine file)",
    "-o --output OUT": Required("output file"),
    "--draws:int N": "largest number of random machines",
    "--digits:int D": "draw until D significant digits are stable (JCGM 101, 7.9.4)",
    "--tolerance-um:float T": "also report the share of machines whose deviation exceeds T µm",
    **SCHEDULER,
    **PDF,
    "--force": "overwrite an existing output",
}


def run(args: argparse.Namespace) -> int:
    """Write S as a table, or a study as a folder."""
    from matstd.twin.files import kind_of, read_text

    path = Path(args.source)
    if kind_of(read_text(path)) == "project":
        return _study(args)
    if args.poses is None:
        raise BadFile(path, "format", "no project", "a project/1, or a machine followed by poses")
    if given := [name for name in _STUDY_ONLY if getattr(args, name) not in (None, False)]:
        option = given[0].replace("_", "-")
        raise DesignError(f"--{option} is for the random machines that a PROJECT.toml describes")
    return _table(args)


def _table(args: argparse.Namespace) -> int:
    """One column a parameter: µm/µm, or µm/µrad for an angular one."""
    from matstd.api.machines import read_machine, sensitivities
    from matstd.progress import stages
    from matstd.twin.files.whole import refuse_to_overwrite

    refuse_to_overwrite(args.output, args.force)
    chain = read_machine(args.source)
    with stages() as show:
        found = sensitivities(chain, args.poses, show)
        found.save(args.output)
    print(f"{args.output}: {len(found.S)} poses, {len(found.names)} parameters")
    say_each(chain.remarks)
    return 0


def _study(args: argparse.Namespace) -> int:
    """Data, pictures and page of a study; the folder appears whole or not at all."""
    from matstd.api.designing import Project
    from matstd.progress import stages
    from matstd.report.words import study_words

    project = Project.read(args.source, montecarlo=_settings(args))
    say_each(project.brief.chain.remarks)
    say_each(project.brief.remarks)
    with stages() as progress:
        made = project.sensitivity(
            args.output,
            args.poses,
            force=args.force,
            progress=progress,
            scheduler=args.scheduler,
            pdf=args.pdf,
        )
    for line in (*made.remarks, *study_words(made.study)):
        print(line)
    print(f"{args.output}: look at report.html")
    return 0


def _settings(args: argparse.Namespace) -> dict[str, float]:
    """Keys of `[montecarlo]` that the command line sets; the project file is checked with them."""
    given = {key: getattr(args, key) for key in ("draws", "digits", "tolerance_um")}
    return {key: value for key, value in given.items() if value is not None}
