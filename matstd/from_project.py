"""What a project asks for, in the terms of placement and planning."""

from artefact.body import Base, Limits, Material
from artefact.brief import BASE_THICKNESS, CORNER_RADIUS, Project
from artefact.layout import Blank, Fittings
from artefact.place import PlacementOptions
from artefact.reach import ProbeReach
from artefact.worth import CriterionOptions, TouchOptions
from probe_paths.plan import Probe
from twin.units import DEG, KG_M3

_LOWEST_SPHERE, _HIGHEST_SPHERE = 60.0, 130.0 / 220.0
"""Of the sphere centres above the seat, mm and as a share of the blank's height: as far apart as
base and patches leave room for."""


def probe(project: Project) -> Probe:
    """The probe in the spindle."""
    return Probe(project.probe_radius, project.probe_length)


def probe_reach(project: Project) -> ProbeReach:
    """Machine, probe, table and place of the standard."""
    tool = probe(project)
    return ProbeReach(
        project.chain,
        project.setup,
        tool.shape,
        tool.length,
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
    wanted = project.standard
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
        ),
        choice=TouchOptions(touches=wanted.touches, poses=wanted.poses),
    )
