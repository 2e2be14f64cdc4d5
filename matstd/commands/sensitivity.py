"""`matstd sensitivity`: S at given poses, or a whole study of a project with its Monte Carlo."""

from __future__ import annotations

import argparse
from typing import TYPE_CHECKING

from matstd.crew import add_scheduler

if TYPE_CHECKING:
    from matstd.project_file import Project
    from sensitivity.study import Study
    from sensitivity.workspace import Workspace
    from twin.frames import Array

_STUDY_ONLY = ("draws", "digits", "tolerance_um", "scheduler")
_SHOWN = 5


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Arguments of the command."""
    parser.description = (
        "With a machine and poses: S of every error parameter at every pose, into a CSV file. With "
        "a project: maps, trajectories and Monte Carlo of its random machines, into a folder."
    )
    parser.add_argument("source", metavar="MACHINE.toml|PROJECT.toml", help="the machine, or more")
    parser.add_argument(
        "poses", metavar="POSES.csv", nargs="?", help="axis readings; else those of the project"
    )
    parser.add_argument("-o", "--output", metavar="OUT", required=True, help="to be written")
    parser.add_argument("--draws", type=int, metavar="N", help="random machines, at most")
    parser.add_argument(
        "--digits", type=int, metavar="D", help="until D digits are stable (JCGM 101, 7.9.4)"
    )
    parser.add_argument(
        "--tolerance-um", type=float, metavar="T", help="share of the machines beyond T µm"
    )
    add_scheduler(parser)
    parser.add_argument("--force", action="store_true", help="overwrite the output")


def run(args: argparse.Namespace) -> int:
    """Write S as a table, or a study as a folder."""
    from pathlib import Path

    from twin.errors import BadFile, DesignError
    from twin.files.toml import parse_toml, read_text

    path = Path(args.source)
    if parse_toml(read_text(path), path).get("format") == "project/1":
        return _study(args)
    if args.poses is None:
        raise BadFile(path, "format", "no project", "a project/1, or a machine followed by poses")
    if given := [name for name in _STUDY_ONLY if getattr(args, name) is not None]:
        option = given[0].replace("_", "-")
        raise DesignError(f"--{option} is for random machines, which a PROJECT.toml describes")
    return _table(args)


def _table(args: argparse.Namespace) -> int:
    """One column a parameter: µm/µm, or µm/µrad for an angular one."""
    from sensitivity.jacobian import sensitivity
    from twin.files.machine_file import read_machine
    from twin.files.pose_file import read_poses
    from twin.files.whole import refuse_to_overwrite, write_whole
    from twin.units import UM, URAD

    refuse_to_overwrite(args.output, args.force)
    chain = read_machine(args.source)
    q, length = read_poses(args.poses, chain)
    unit = [URAD / UM if symbol.is_angular else 1.0 for symbol in chain.symbols]
    lines = [",".join(symbol.name for symbol in chain.symbols)]
    lines += [",".join(f"{v:.9g}" for v in row) for row in sensitivity(chain, q, length) * unit]
    write_whole(args.output, "\n".join(lines) + "\n")
    print(f"{args.output}: {len(q)} poses, {len(chain.symbols)} parameters")
    return 0


def _study(args: argparse.Namespace) -> int:
    """Data, pictures and page of a study; the folder appears whole or not at all."""
    from matstd.crew import hired
    from matstd.folder import results_folder
    from matstd.project_file import read_project

    project = read_project(args.source, _settings(args))
    workspace, poses = _where(project, args.poses)
    with results_folder(args.output, args.force) as folder:
        import numpy as np

        from matstd.console import stages
        from matstd.report_study import write_study_page
        from sensitivity.maps import draw_maps
        from sensitivity.study import run_study
        from sensitivity.study_file import write_study
        from sensitivity.trajectory_pictures import draw_path

        rng_study, rng_maps = (np.random.default_rng(project.seed).spawn(4)[i] for i in (0, 3))
        with stages() as progress, hired(args.scheduler) as crew:
            study = run_study(
                project.population,
                workspace,
                poses,
                project.draws,
                rng_study,
                progress,
                project.tolerance,
                project.digits,
                crew,
            )
            progress("maps", 0, 1)
            write_study(study, folder)
            shown = draw_maps(study, folder, rng_maps) + draw_path(study, folder)
            remarks = write_study_page(study, folder, shown, args.source)
    for line in [*remarks, *_words(study)]:
        print(line)
    print(f"{args.output}: look at report.html")
    return 0


def _settings(args: argparse.Namespace) -> dict[str, float]:
    """Keys of `[montecarlo]` that the command line sets; the project file is checked with them."""
    given = {key: getattr(args, key) for key in ("draws", "digits", "tolerance_um")}
    return {key: value for key, value in given.items() if value is not None}


def _where(project: Project, poses_file: str | None) -> tuple[Workspace, int | Array]:
    """Workspace and poses, of the project or of a pose file."""
    import numpy as np

    from sensitivity.workspace import Workspace
    from twin.errors import BadFile
    from twin.files.pose_file import read_poses

    chain, length = project.chain, project.probe_length
    if poses_file is None:
        return Workspace(chain, project.workspace, length), project.poses
    q, lengths = read_poses(poses_file, chain)
    if np.ptp(lengths) > 0.0:
        span = f"{lengths.min():g} to {lengths.max():g}"
        raise BadFile(poses_file, "tool_length_mm", span, "one tool length for a study")
    return Workspace(chain, project.workspace, float(lengths[0]) or length), q


def _words(study: Study) -> list[str]:
    """The study in a few lines."""
    from twin.units import UM

    v = study.volumetric
    lines = [
        v.statement,
        f"volumetric error over {len(study.q)} poses: mean {v.mean.mean() / UM:.1f} µm, "
        f"P95 {v.p95.mean() / UM:.1f} µm, at the worst pose {v.p95.max() / UM:.1f} µm",
    ]
    if v.tolerance < float("inf"):
        lines.append(
            f"beyond {v.tolerance / UM:g} µm: on average {v.exceedance.mean():.1%} "
            f"of the machines, {v.exceedance.max():.1%} at the worst pose"
        )
    ranked = ", ".join(f"{name} {share:.1%}" for name, share in study.ranking()[:_SHOWN])
    lines.append(f"largest shares of the variance: {ranked}")
    return lines
