"""A study of a project's machines: streams of random numbers, poses, and its figures."""

from pathlib import Path
from typing import NamedTuple

import numpy as np

from matstd.artefact.brief import Brief
from matstd.report.maps import draw_maps, draw_path
from matstd.report.pages import write_study_page
from matstd.report.words import sampling_words
from matstd.sensitivity.first_order import Workspace
from matstd.sensitivity.montecarlo import Workers
from matstd.sensitivity.study import Study, run_study, write_study
from matstd.twin.compute import Progress
from matstd.twin.errors import BadFile
from matstd.twin.files import read_poses
from matstd.twin.frames import Array


class Streams(NamedTuple):
    """Independent streams of one seed.

    The order is part of the results: a stream depends on its place in it, so a new one goes to the
    end.
    """

    study: np.random.Generator  # random machines of the sensitivity study
    placement: np.random.Generator  # candidates and restarts of the search for standard and touches
    # machines that are probed and identified, their noise, poses that judge them
    proof: np.random.Generator
    # random machines that show what errors do to the length of the deviation
    maps: np.random.Generator
    other_setups: np.random.Generator  # poses at which other ways to measure are weighed
    # what calibration leaves open of the standard, noise and clamping of every visit
    visits: np.random.Generator


def streams(seed: int) -> Streams:
    """The streams of a seed."""
    return Streams(*np.random.default_rng(seed).spawn(len(Streams._fields)))


def study_project(
    brief: Brief, poses_file: str | Path | None, folder: Path, progress: Progress, workers: Workers
) -> tuple[Study, list[str]]:
    """Data, pictures and page of a study, written into a folder.

    Args:
        poses_file: Where the machines are looked at; None for poses of the project's workspace.
        progress: Called with stage, done and total.
        workers: Who draws the machines; None for this process.

    Raises:
        BadFile: Poses of several tool lengths.
    """
    where = _where(brief, poses_file)
    study, shown = study_and_maps(brief, *where, folder, streams(brief.seed), progress, workers)
    remarks = write_study_page(study, folder, shown, str(brief.path))
    return study, remarks


def study_and_maps(
    brief: Brief,
    workspace: Workspace,
    poses: int | Array,
    folder: Path,
    rng: Streams,
    progress: Progress,
    workers: Workers,
) -> tuple[Study, list[tuple[str, str]]]:
    """The study of a brief, its data written into a folder, and its maps with their captions."""
    study = run_study(
        brief.population,
        workspace,
        poses=poses,
        draws=brief.study.draws,
        rng=rng.study,
        progress=progress,
        tolerance=brief.study.tolerance,
        digits=brief.study.digits,
        workers=workers,
    )
    progress("maps", 0, 1)
    write_study(study, folder, sampling_words(study.volumetric))
    return study, draw_maps(study, folder, rng.maps) + draw_path(study, folder)


def _where(brief: Brief, poses_file: str | Path | None) -> tuple[Workspace, int | Array]:
    """Workspace and poses, of the project or of a pose file."""
    if poses_file is None:
        return brief.workspace, brief.study.poses
    q, lengths = read_poses(poses_file, brief.chain)
    if np.ptp(lengths) > 0.0:
        span = f"{lengths.min():g} to {lengths.max():g}"
        raise BadFile(poses_file, "tool_length_mm", span, "one tool length for a study")
    length = float(lengths[0]) or brief.probe.length
    return Workspace(brief.chain, brief.ranges, length), q
