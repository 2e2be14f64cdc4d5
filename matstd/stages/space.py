"""Whether the wanted patches stand on the blank, can be touched there, and are not too heavy.

Looked at before anything else is done; a refusal names the nearest wishes that can be met, each of
which was tried.
"""

from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path

import numpy as np

from matstd.artefact.brief import FEWEST_PATCHES, Project
from matstd.artefact.layout import WALL_GAP, least_gap
from matstd.artefact.place import Room, check_room, room_for
from matstd.report.plots import draw_room
from matstd.report.style import save
from matstd.stages.from_project import blank, placement_options, probe_reach
from matstd.twin.errors import NotBuildable
from matstd.twin.frames import Array

PICTURE = "room.png"
"""Of the patches that fit on the blank; only a refusal draws it."""

_LARGER, _SMALLER = (1.1, 1.25, 1.5), (0.95, 0.9, 0.85)  # sides of the blank
_CLOSER = (0.5, 0.2)  # of the gap
_STEEPER = (5.0, 15.0, 30.0)  # degrees
_LEAST_SIDE = 160.0  # mm
_STEEPEST = 60.0  # degrees, that any face has


def check_space(project: Project, folder: Path, poses: Array) -> None:
    """Refuse a standard that cannot be, with a picture of the patches that fit if some do not.

    Args:
        project: What is wanted.
        folder: For the picture.
        poses: Table poses to choose from, (K, R), rad.

    Raises:
        NotBuildable: What binds (facts `fitting`, `binding`), and the nearest wishes (`wishes`).
    """
    room = _room(project, poses)
    if not room.is_enough:
        save(draw_room(room), folder / PICTURE)
    try:
        check_room(room)
    except NotBuildable as error:
        wishes = _nearest(project, room, poses)
        raise NotBuildable(str(error), **error.facts, wishes=wishes) from error


def _room(project: Project, poses: Array) -> Room:
    made, options = blank(project), placement_options(project)
    return room_for(options.patches, probe_reach(project), made, poses, options.sites, project.seed)


def _nearest(project: Project, room: Room, poses: Array) -> list[str]:
    """The smallest change of every kind that would do."""
    found = []
    if not room.is_light:  # what the lightest weighs is known
        found.append(f"limits.max_mass_kg = {np.ceil(10.0 * room.least) / 10.0:g}")
    kinds = (_fewer, _closer, _steeper, _resized)
    for wishes in (kind(project, room) for kind in kinds):
        for words, other in wishes:
            try:
                there = _room(other, poses)
            except NotBuildable:
                continue
            if there.is_enough and there.is_light:
                found.append(words)
                break
    return found


def _fewer(project: Project, room: Room) -> Iterator[tuple[str, Project]]:
    """As many patches as fit, or one less: each is larger then."""
    for fewer in (len(room.faces), len(room.faces) - 1):
        if fewer >= FEWEST_PATCHES and not room.is_enough:
            other = project.standard.model_copy(update={"patches": fewer})
            yield f"standard.patches = {fewer}", replace(project, standard=other)


def _closer(project: Project, room: Room) -> Iterator[tuple[str, Project]]:
    """A smaller gap, where it is that which keeps bodies apart and not the cutter."""
    gap = project.limits.gap_mm
    for share in _CLOSER if least_gap(room.blank.limits) > WALL_GAP and not room.is_enough else ():
        other = project.limits.model_copy(update={"gap_mm": float(round(share * gap))})
        yield f"limits.gap_mm = {other.gap_mm:g}", replace(project, limits=other)


def _steeper(project: Project, room: Room) -> Iterator[tuple[str, Project]]:
    """Faces that look more towards a probe that finds no way to them."""
    for more in _STEEPER if room.is_hidden else ():
        if (slope := project.limits.max_slope_deg + more) <= _STEEPEST:
            other = project.limits.model_copy(update={"max_slope_deg": slope})
            yield f"limits.max_slope_deg = {slope:g}", replace(project, limits=other)


def _resized(project: Project, room: Room) -> Iterator[tuple[str, Project]]:
    """A smaller blank for less mass, a larger one for more room."""
    factors = () if room.is_hidden else _LARGER if room.is_light else _SMALLER
    for factor in factors:
        sides = tuple(round(factor * side) for side in project.blank.base_mm)
        if min(sides) >= _LEAST_SIDE and max(sides) <= 2.0 * project.table_radius:
            other = project.blank.model_copy(update={"base_mm": sides})
            yield f"blank.base_mm = [{sides[0]}, {sides[1]}]", replace(project, blank=other)
