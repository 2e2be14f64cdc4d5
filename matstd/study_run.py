"""A study of a project's random machines: where, how many, and its figures in a few lines."""

from pathlib import Path

import numpy as np

from artefact.brief import Project
from report.maps import draw_maps, draw_path
from report.pages import write_study_page
from sensitivity.first_order import Workspace
from sensitivity.montecarlo import Crew
from sensitivity.study import Study, run_study, write_study
from twin.compute import Progress
from twin.errors import BadFile
from twin.files import read_poses
from twin.frames import Array
from twin.units import UM

_SHOWN = 5  # parameters with the largest shares


def study_project(
    project: Project, poses_file: str | None, folder: Path, progress: Progress, crew: Crew
) -> list[str]:
    """Data, pictures and page of a study, written into a folder.

    Args:
        project: Machine and errors.
        poses_file: Where the machines are looked at; None for poses of the project's workspace.
        folder: Empty folder.
        progress: Told what is going on.
        crew: Who draws the machines; None for this process.

    Returns:
        What could not be drawn, and the figures, one line each.

    Raises:
        BadFile: Poses of several tool lengths.
    """
    workspace, poses = _where(project, poses_file)
    rng_study, rng_maps = (np.random.default_rng(project.seed).spawn(4)[i] for i in (0, 3))
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
    remarks = write_study_page(study, folder, shown, str(project.path))
    return [*remarks, *study_words(study)]


def _where(project: Project, poses_file: str | None) -> tuple[Workspace, int | Array]:
    """Workspace and poses, of the project or of a pose file."""
    chain, length = project.chain, project.probe_length
    if poses_file is None:
        return Workspace(chain, project.workspace, length), project.poses
    q, lengths = read_poses(poses_file, chain)
    if np.ptp(lengths) > 0.0:
        span = f"{lengths.min():g} to {lengths.max():g}"
        raise BadFile(poses_file, "tool_length_mm", span, "one tool length for a study")
    return Workspace(chain, project.workspace, float(lengths[0]) or length), q


def study_words(study: Study) -> list[str]:
    """The study in a few lines."""
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
