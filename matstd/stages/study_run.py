"""A study of a project's random machines: where, how many, and its figures in a few lines."""

from pathlib import Path

import numpy as np

from matstd.artefact.brief import Project
from matstd.report.maps import draw_maps, draw_path
from matstd.report.pages import write_study_page
from matstd.report.words import sampling_words, study_words
from matstd.sensitivity.first_order import Workspace
from matstd.sensitivity.montecarlo import Workers
from matstd.sensitivity.study import Study, run_study, write_study
from matstd.stages.streams import Streams, streams
from matstd.twin.compute import Progress
from matstd.twin.errors import BadFile
from matstd.twin.files import read_poses
from matstd.twin.frames import Array


def study_project(
    project: Project, poses_file: str | None, folder: Path, progress: Progress, workers: Workers
) -> list[str]:
    """Data, pictures and page of a study, written into a folder.

    Args:
        project: Machine and errors.
        poses_file: Where the machines are looked at; None for poses of the project's workspace.
        folder: Empty folder.
        progress: Told what is going on.
        workers: Who draws the machines; None for this process.

    Returns:
        What could not be drawn, and the figures, one line each.

    Raises:
        BadFile: Poses of several tool lengths.
    """
    where = _where(project, poses_file)
    study, shown = study_and_maps(project, *where, folder, streams(project.seed), progress, workers)
    remarks = write_study_page(study, folder, shown, str(project.path))
    return [*remarks, *study_words(study)]


def study_and_maps(
    project: Project,
    workspace: Workspace,
    poses: int | Array,
    folder: Path,
    rng: Streams,
    progress: Progress,
    workers: Workers,
) -> tuple[Study, list[tuple[str, str]]]:
    """The study of a project, its data written into a folder, and its maps with their captions."""
    study = run_study(
        project.population,
        workspace,
        poses=poses,
        draws=project.draws,
        rng=rng.study,
        progress=progress,
        tolerance=project.tolerance,
        digits=project.digits,
        workers=workers,
    )
    progress("maps", 0, 1)
    write_study(study, folder, sampling_words(study.volumetric))
    return study, draw_maps(study, folder, rng.maps) + draw_path(study, folder)


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
