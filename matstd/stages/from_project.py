"""What a project asks for, in the terms of placement and planning."""

from dataclasses import replace

import numpy as np

from matstd.artefact.body import Base, Limits, Material
from matstd.artefact.brief import BASE_THICKNESS, CORNER_RADIUS, BodyTable, ProbeTable, Project
from matstd.artefact.layout import Blank, Fittings
from matstd.artefact.place import PlacementOptions
from matstd.artefact.reach import (
    DatumBall,
    ProbeReach,
    Solid,
    Workshop,
    covering_solids,
    round_table,
    still_frames,
)
from matstd.artefact.seat import (
    middle_room,
)
from matstd.artefact.worth import Calibration, CriterionOptions, TouchOptions
from matstd.probe_paths.emit import SEARCH, Feeds
from matstd.probe_paths.language import Dialect, checked_name, read_dialect
from matstd.probe_paths.plan import PlanOptions, Probe, Sensor
from matstd.probe_paths.stations import Clamping, with_tool
from matstd.twin.errors import BadFile
from matstd.twin.frames import pose, rotation
from matstd.twin.units import DEG, KG_M3, UM, URAD

_LOWEST_SPHERE, _HIGHEST_SPHERE = 60.0, 130.0 / 220.0
"""Of the sphere centres above the seat, mm and as a share of the blank's height: as far apart as
base and patches leave room for."""

_ROOM, _ROOM_OF_BALL = 2.0, 2.0 / 3.0
"""Largest gap kept round the probe, mm, and the same as a share of the ball's radius."""


_DROPPED = 0.1
"""Of the touches that a plan may drop, each with its reason: the choice knows of room at touches,
the plan of every move."""


def probe(project: Project) -> Probe:
    """The probe that the standard is designed for."""
    return _probe(project.probe)


def probes(project: Project) -> list[Probe]:
    """That probe, then those that make what it does not reach."""
    return [probe(project), *map(_probe, project.further_probes)]


def _probe(stated: ProbeTable) -> Probe:
    assert stated.radius_mm is not None
    assert stated.length_mm is not None
    return Probe(
        radius=stated.radius_mm,
        length=stated.length_mm,
        stack=tuple((end, 0.5 * diameter) for end, diameter in stated.stack_mm or ()),
        nose_radius=0.5 * stated.nose_diameter_mm,
    )


def clampings(project: Project) -> list[Clamping]:
    """Where the standard is clamped, the first for the design, and what stands beside it there."""
    setups = [project.setup, *project.further_setups]
    return [Clamping(setup, workshop(project, setup.name)) for setup in setups]


def workshop(project: Project, setup: str = "") -> Workshop:
    """What stands beside the standard; bodies that are drawn elsewhere are covered by boxes.

    Args:
        project: What is wanted.
        setup: Name of a set-up; empty for the first.

    Raises:
        BadFile: A mesh that cannot be read.
        DesignError: A body on an axis that does not carry the workpiece.
    """
    table = table_of(project)
    here = ("", setup or project.setup.name)
    stated_here = [body for body in project.workshop.bodies if body.setup in here]
    bodies = [solid for body in stated_here for solid in solids_of(project, body)]
    made = Workshop(table, tuple(bodies), _ball(project, table))
    still_frames(made.on, project.chain, np.zeros((1, len(project.chain.axes))))
    return made


def _ball(project: Project, table: Solid) -> DatumBall | None:
    stated = project.workshop.ball
    if stated is None:
        return None
    size = (0.5 * stated.diameter_mm, 0.5 * stated.stem_diameter_mm)
    return DatumBall(*stated.at_mm, *size, table.high, 0.5 * stated.u_um * UM)


def table_of(project: Project) -> Solid:
    """Face of the table, as stated."""
    stated = project.workshop.table
    if stated is None:
        return round_table(project.table_radius)
    a, b = stated.sides_mm or (stated.diameter_mm or 0.0,) * 2
    return Solid(
        round_table().name,
        (0.5 * a, 0.5 * b),
        stated.sides_mm is None,
        stated.height_mm - stated.thickness_mm,
        stated.height_mm,
    )


def solids_of(project: Project, body: BodyTable) -> list[Solid]:
    """One body as the prisms that a program can state."""
    x, y, z = body.at_mm
    if body.stl is not None:
        place = pose(rotation(np.array([0.0, 0.0, body.turned_deg * DEG])), np.array([x, y, z]))
        return covering_solids(project.path.parent / body.stl, body.name, place, body.on)
    assert body.height_mm is not None
    a, b = body.sides_mm or (body.diameter_mm or 0.0,) * 2
    return [
        Solid(
            body.name,
            (0.5 * a, 0.5 * b),
            body.sides_mm is None,
            z,
            z + body.height_mm,
            x,
            y,
            body.turned_deg * DEG,
            body.on,
        )
    ]


def dialect(project: Project) -> Dialect:
    """Words of the control for which programs are written, and numbers of this workshop.

    Raises:
        BadFile: A folder for a control that takes none, planes of one that has none, or of a
            machine that turns its tool.
    """
    stated = project.workshop
    words = read_dialect(project.control, project.path.parent)
    if "folder" in stated.model_fields_set and not words.folder:
        raise BadFile(project.path, "workshop.folder", stated.folder, "nothing for this control")
    keys = {"folder": "folder", "tool": "tool", "preset": "preset", "height_read": "result_height"}
    given = {keys[k]: getattr(stated, k) for k in keys if k in stated.model_fields_set}
    sensors = tuple(
        Sensor(name, table.parameter, table.factor, table.offset)
        for name, table in stated.temperatures.items()
    )
    if sensors and words.language != "klartext":
        found = f"{len(sensors)} sensors for {project.control}"
        expected = "a control that hands them over as Q100 to Q107; else evaluate --sensors"
        raise BadFile(project.path, "workshop.temperatures", found, expected)
    return replace(words, is_tilted=_is_tilted(project, words), sensors=sensors, **given)


def _is_tilted(project: Project, words: Dialect) -> bool:
    """Whether programs use planes, which control and machine must be made for."""
    asked = project.workshop.strategy
    if asked != "plane-spatial":
        return False
    chain = project.chain
    turns = [a for a in chain.rotary_axes if not chain.link(a).carries_workpiece]
    for why in (
        "a dialect with has_planes = true" if not words.has_planes else "",
        f"axes on this machine, whose tool {turns[0]} turns" if turns else "",
    ):
        if why:
            raise BadFile(project.path, "workshop.strategy", repr(asked), why)
    return True


def dialects(project: Project) -> list[Dialect]:
    """The same for every probe.

    Raises:
        BadFile: As of `dialect`.
        DesignError: Names of programs that no control takes.
    """
    first = dialect(project)
    words = [first, *(with_tool(first, one.tool) for one in project.further_probes)]
    for setup in project.further_setups:
        checked_name(f"{words[-1].prefix}_{setup.name.upper()}_{SEARCH}")
    return words


def feeds(project: Project) -> Feeds:
    """Feeds of the programs, and where a file ends."""
    stated = project.workshop
    return Feeds(
        probing=float(stated.probing_feed_mm_min),
        approach=float(stated.approach_feed_mm_min),
        turning=float(stated.turning_feed_deg_min),
        touches_per_file=stated.touches_per_file,
        minutes_per_file=stated.minutes_per_file or np.inf,
    )


def plan_options(project: Project) -> PlanOptions:
    """How carefully touches are made: with half the room that they are chosen for."""
    return PlanOptions(
        smallest_gap=0.5 * _room(project),
        clearance=project.workshop.clearance_mm,
        tolerated=int(_DROPPED * project.standard.touches),
        retract=project.workshop.retract_mm,
        workshop=workshop(project),
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
        workshop=workshop(project),
    )


def blank(project: Project) -> Blank:
    """Blank, fittings, material and limits of the standard."""
    limits, stuff = project.limits, project.material
    (a, b), height = project.blank.base_mm, project.blank.height_mm
    low, high = _LOWEST_SPHERE, _HIGHEST_SPHERE * height
    setups = (project.setup, *project.further_setups)
    rooms = [middle_room(table_of(project), setup.T_table_artefact) for setup in setups]
    return Blank(
        base=Base((0.5 * a, 0.5 * b), CORNER_RADIUS, BASE_THICKNESS),
        fittings=Fittings(sphere_heights=(low, round(0.5 * (low + high), 1), round(high, 1))),
        material=Material(
            stuff.name,
            stuff.density_kg_m3 * KG_M3,
            stuff.expansion_1_K,
            u_expansion=stuff.expansion_u_1_K,
            modulus=stuff.modulus_MPa,
            poisson=stuff.poisson,
        ).with_usual_modulus(),
        height=height,
        limits=Limits(
            min_concave_radius=limits.min_concave_radius_mm,
            max_slope=limits.max_slope_deg * DEG,
            ball_radius=project.probe_radius,
            gap=limits.gap_mm,
            max_mass=limits.max_mass_kg,
            # screws and pads stand on the table in every set-up
            table_radius=min(rooms),
            slot_pitch=limits.slot_pitch_mm,
        ),
    )


def placement_options(project: Project) -> PlacementOptions:
    """How much is tried and measured, and what for."""
    wanted, known = project.standard, project.calibration
    return PlacementOptions(
        name=wanted.name,
        serial=wanted.serial,
        patches=wanted.patches,
        balls=wanted.balls,
        noise=project.noise,
        criterion=CriterionOptions(
            name=wanted.criterion,
            potential=wanted.potential,
            robust_machines=wanted.robust_machines,
            robust_share=wanted.robust_share,
            calibration=Calibration(
                patch=known.patch_um * UM,
                patch_tilt=known.patch_urad * URAD,
                ball=known.ball_um * UM,
            ),
        ),
        choice=TouchOptions(wanted.touches, wanted.poses, wanted.proof_touches),
    )
