"""What a project asks for, in the terms of placement and planning."""

from artefact.body import Base, Limits, Material
from artefact.brief import BASE_THICKNESS, CORNER_RADIUS, Project
from artefact.layout import Blank, Fittings
from artefact.place import PlacementOptions
from artefact.reach import ProbeReach
from artefact.worth import Calibration, CriterionOptions, TouchOptions
from probe_paths.language import Dialect, read_dialect
from probe_paths.plan import PlanOptions, Probe
from twin.units import DEG, KG_M3, UM, URAD

_LOWEST_SPHERE, _HIGHEST_SPHERE = 60.0, 130.0 / 220.0
"""Of the sphere centres above the seat, mm and as a share of the blank's height: as far apart as
base and patches leave room for."""

_ROOM, _ROOM_OF_BALL = 2.0, 2.0 / 3.0
"""Largest gap kept round the probe, mm, and the same as a share of the ball's radius."""


def probe(project: Project) -> Probe:
    """The probe in the spindle."""
    stated = project.probe
    return Probe(
        radius=project.probe_radius,
        length=project.probe_length,
        stylus_length=stated.stylus_length_mm or 0.0,
        stylus_radius=0.5 * (stated.stylus_diameter_mm or 0.0),
        body_radius=0.5 * stated.body_diameter_mm,
        nose_radius=0.5 * stated.nose_diameter_mm,
    )


def dialect(project: Project) -> Dialect:
    """Words of the control for which programs are written."""
    return read_dialect(project.control, project.path.parent)


def plan_options(project: Project) -> PlanOptions:
    """How carefully touches are made: with half the room that they are chosen for."""
    return PlanOptions(
        smallest_gap=0.5 * _room(project), table_radius=project.limits.table_radius_mm
    )


def _room(project: Project) -> float:
    """Gap between the probe above its ball and anything solid, mm.

    The stylus has two thirds of the ball's radius, so that beside a face it has a third of it and
    never more: what a ball of 3 mm is given would bar a smaller one from every touch.
    """
    return min(_ROOM, _ROOM_OF_BALL * project.probe_radius)


def probe_reach(project: Project) -> ProbeReach:
    """Machine, probe, table and place of the standard."""
    tool = probe(project)
    return ProbeReach(
        chain=project.chain,
        setup=project.setup,
        shape=tool.shape,
        length=tool.length,
        room=_room(project),
        table_radius=project.limits.table_radius_mm,
    )


def blank(project: Project) -> Blank:
    """Blank, fittings, material and limits of the standard."""
    wanted, limits = project.standard, project.limits
    (a, b), height = project.blank.base_mm, project.blank.height_mm
    low, high = _LOWEST_SPHERE, _HIGHEST_SPHERE * height
    return Blank(
        base=Base((0.5 * a, 0.5 * b), CORNER_RADIUS, BASE_THICKNESS),
        fittings=Fittings(sphere_heights=(low, round(0.5 * (low + high), 1), round(high, 1))),
        material=Material(wanted.material, wanted.density_kg_m3 * KG_M3, wanted.expansion_per_K),
        height=height,
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
    wanted, known = project.standard, project.calibration
    return PlacementOptions(
        name=wanted.name,
        serial=wanted.serial,
        patches=wanted.patches,
        noise=project.noise,
        criterion=CriterionOptions(
            name=wanted.criterion,
            potential=wanted.potential,
            drawn_machines=wanted.drawn_machines,
            worst_share=wanted.worst_share,
            calibration=Calibration(
                patch=known.patch_um * UM,
                patch_tilt=known.patch_urad * URAD,
                ball=known.ball_um * UM,
            ),
        ),
        choice=TouchOptions(touches=wanted.touches, poses=wanted.poses),
    )
