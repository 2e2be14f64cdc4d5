"""What a project asks for, in the terms of placement and planning."""

from artefact.constraints import Limits
from artefact.placement import PlacementOptions
from artefact.sites import Fittings, Frame
from artefact.standard import Base, Material
from artefact.touchable import Probing
from matstd.project_file import Project
from matstd.standard_tables import BASE_THICKNESS, CORNER_RADIUS
from probe_paths.plan import PlanOptions
from probe_paths.probe import Probe
from twin.units import DEG, KG_M3

_LOWEST_SPHERE, _HIGHEST_SPHERE = 60.0, 130.0 / 220.0
"""Of the sphere centres above the seat, mm and as a share of the blank's height: as far apart as
base and patches leave room for."""

_ROOM, _ROOM_OF_BALL = 2.0, 2.0 / 3.0
"""Largest gap kept round the probe, mm, and the same as a share of the ball's radius."""


def probe(project: Project) -> Probe:
    """The probe in the spindle."""
    return Probe(project.probe_radius, project.probe_length)


def plan_options(project: Project) -> PlanOptions:
    """How carefully touches are made: with half the room that they are chosen for."""
    return PlanOptions(room=0.5 * _room(project), table_radius=project.limits.table_radius_mm)


def _room(project: Project) -> float:
    """Gap between the probe above its ball and anything solid, mm.

    The stylus has two thirds of the ball's radius, so that beside a face it has a third of it and
    never more: what a ball of 3 mm is given would bar a smaller one from every touch.
    """
    return min(_ROOM, _ROOM_OF_BALL * project.probe_radius)


def probing(project: Project) -> Probing:
    """Machine, probe, table and place of the standard."""
    tool = probe(project)
    return Probing(
        project.chain,
        project.setup,
        tool.shape,
        tool.length,
        room=_room(project),
        table_radius=project.limits.table_radius_mm,
    )


def frame(project: Project) -> Frame:
    """Blank, fittings, material and limits of the standard."""
    wanted, blank, limits = project.standard, project.blank, project.limits
    a, b = blank.base_mm
    low, high = _LOWEST_SPHERE, _HIGHEST_SPHERE * blank.height_mm
    return Frame(
        base=Base((0.5 * a, 0.5 * b), CORNER_RADIUS, BASE_THICKNESS),
        fittings=Fittings(sphere_heights=(low, round(0.5 * (low + high), 1), round(high, 1))),
        material=Material(wanted.material, wanted.density_kg_m3 * KG_M3, wanted.expansion_per_K),
        blank_height=blank.height_mm,
        limits=Limits(
            min_concave_radius=limits.min_concave_radius_mm,
            max_slope=limits.max_slope_deg * DEG,
            ball_radius=project.probe_radius,
            gap=limits.gap_mm,
            max_mass=limits.max_mass_kg,
        ),
    )


def placement_options(project: Project) -> PlacementOptions:
    """How much is tried and measured, and what for."""
    wanted = project.standard
    return PlacementOptions(
        name=wanted.name,
        serial=wanted.serial,
        patches=wanted.patches,
        touches=wanted.touches,
        poses=wanted.poses,
        noise=project.noise,
        criterion=wanted.criterion,
        potential=wanted.potential,
        draws=wanted.drawn_machines,
        tail=wanted.worst_share,
    )
