"""The request of a design, resolved once: everything downstream takes this record.

project.toml, machine.toml, task.toml -> read_project -> Brief -> feasibility, design_standard
"""

from collections.abc import Mapping
from dataclasses import dataclass, field
from functools import cached_property
from pathlib import Path
from typing import Literal

import numpy as np

from matstd.artefact.brief.task_file import Task
from matstd.artefact.hidden import Scan
from matstd.artefact.layout import Blank
from matstd.artefact.reach import (
    Body,
    Clamping,
    DatumBall,
    ProbeReach,
    Solid,
    Workshop,
    round_table,
)
from matstd.artefact.tool import Probe
from matstd.artefact.worth import CriterionOptions, TouchOptions
from matstd.sensitivity.first_order import Workspace
from matstd.sensitivity.population import Population
from matstd.twin.display import Displayed
from matstd.twin.frames import Array
from matstd.twin.machine import Chain
from matstd.twin.record import Setup
from matstd.twin.units import UM

_ROOM, _ROOM_OF_BALL = 2.0, 2.0 / 3.0
"""Largest gap round the probe, mm, and the gap as a share of the ball's radius."""


Goal = Literal["prove", "identify", "worst", "minutes", "price"]
"""What decides between families of features."""


@dataclass(frozen=True)
class PlacementOptions:
    """Size of the standard, number of candidates, and design criterion."""

    name: str = "FFS"
    serial: str = ""
    patches: int = 6
    balls: int = 13  # largest number of balls; fewer where there is no room for more
    sites: int = 400  # number of random faces to choose from
    noise: float = 1.0 * UM  # standard deviation of one touch, mm
    # by which faces, balls, poses and touches are chosen
    criterion: CriterionOptions = field(default_factory=lambda: CriterionOptions(potential=0.3))
    choice: TouchOptions = field(default_factory=TouchOptions)
    # features that prove: `faces`, `flat`, `wavy`, `balls`, or `auto` for those that win
    family: str = "faces"
    goal: Goal = "prove"  # what decides between the families
    scan: Scan | None = None  # how a control scans faces; None where it touches only


@dataclass(frozen=True)
class ProgramSettings:
    """The control and the motions of its programs. None leaves a value to the dialect."""

    control: str = "itnc530"  # name of a dialect, or a dialect file of the user's own
    folder: str | None = None
    tool: int | None = None
    further_tools: tuple[int, ...] = ()  # tool numbers of the further probes
    preset: int | None = None
    # point whose height a result states: `gauge` or `tip`
    height_read: Literal["gauge", "tip"] | None = None
    clearance: float = 20.0  # height of the tool above everything while it moves sideways, mm
    retract: float = 1.0  # below the upper end of Z's travel, where rotary axes may turn, mm
    probing_feed: float = 250.0  # as it stands in a program, mm/min
    approach_feed: float = 2000.0  # along Z below the clearance height, mm/min
    turning_feed: float = 1000.0  # of the last motion towards a rotary position, degrees/min
    touches_per_file: int = 400  # number of touches after which the next visit begins a new file
    minutes_per_file: float = np.inf  # longest duration of a file that holds more than one visit
    dry_run: float = 100.0  # height by which dry runs are raised, mm
    planes: bool = False  # whether positions are stated in tilted planes
    # sensors by name: number of the Q parameter, factor and offset of its value
    temperatures: Mapping[str, tuple[int, float, float]] = field(default_factory=dict)


@dataclass(frozen=True)
class StudySettings:
    """Random machines of the maps, and of the proof on the twin."""

    poses: int = 2000
    # number of random machines for the maps; the largest number where digits are set
    draws: int = 2000
    digits: int = 0  # significant digits that must be stable (JCGM 101); 0 for no such test
    tolerance: float = np.inf  # allowed volumetric error, mm; infinite where none is stated
    machines: int = 3  # number of random machines of the proof
    visits: int = 10  # number of virtual visits from which the uncertainty of the task is evaluated
    body_temperature: float = 22.0  # of the standard on the twin as its thermometer reads, degC
    body_u: float = 0.3  # standard uncertainty of that reading, K


@dataclass(frozen=True, eq=False, repr=False)
class Brief(Displayed):
    """The request of a design in base units."""

    chain: Chain
    # smallest and largest reading of every axis in the workspace, mm or rad; an axis left out has
    # its whole travel
    ranges: Mapping[str, tuple[float, float]] = field(default_factory=dict)
    errors: Population | None = None  # expected machines; None for the default population
    # first the probe of the design, then probes for what it does not reach
    probes: tuple[Probe, ...] = (Probe(),)
    # poses of the standard; the first is that of the design
    setups: tuple[Setup, ...] = (Setup("a"),)
    table: Solid = field(default_factory=round_table)
    bodies: tuple[Body, ...] = ()
    ball: DatumBall | None = None  # datum ball that monitors the probe; None where there is none
    # base, fittings, material and limits of the standard
    blank: Blank = field(default_factory=Blank)
    overhang: float = 0.0  # allowed reach of the base beyond the edge of the table, mm
    riser: float = 0.0  # height of a riser or pallet under the seat, mm
    # least natural frequency of the standard on rigid screws, Hz; 0 for any
    first_mode: float = 0.0
    options: PlacementOptions = field(default_factory=PlacementOptions)
    programs: ProgramSettings = field(default_factory=ProgramSettings)
    study: StudySettings = field(default_factory=StudySettings)
    task: Task = field(default_factory=Task)  # measuring task; by default every touch on the faces
    seed: int = 0
    down: str = "-Z"  # direction of weight in machine coordinates
    author: str = "not stated"
    organisation: str = "not stated"
    approved: str = "not stated"
    date: str = "not stated"
    path: Path = Path("project.toml")
    machine_path: Path | None = None  # the machine file; None where there is none
    remarks: tuple[str, ...] = ()

    @property
    def probe(self) -> Probe:
        """The probe of the design."""
        return self.probes[0]

    @property
    def setup(self) -> Setup:
        """The set-up of the design."""
        return self.setups[0]

    @property
    def noise(self) -> float:
        """Standard deviation of one touch, mm."""
        return self.options.noise

    @property
    def room(self) -> float:
        """Gap between the probe above its ball and anything solid, mm.

        The stylus has two thirds of the ball's radius, which leaves a third of it beside a steep
        face: the gap of a 3 mm ball would exclude every touch of a smaller one.
        """
        return min(_ROOM, _ROOM_OF_BALL * self.probe.radius)

    @cached_property
    def clampings(self) -> tuple[Clamping, ...]:
        """Set-ups with the bodies beside the standard in each."""
        return tuple(
            Clamping(
                setup,
                Workshop(
                    self.table,
                    tuple(
                        solid
                        for body in self.bodies
                        if body.setup in ("", setup.name)
                        for solid in body.solids
                    ),
                    self.ball,
                ),
            )
            for setup in self.setups
        )

    @cached_property
    def reach(self) -> ProbeReach:
        """Machine and probe in the first set-up."""
        return ProbeReach(
            chain=self.chain,
            setup=self.setup,
            shape=self.probe.shape,
            length=self.probe.length,
            room=self.room,
            workshop=self.clampings[0].workshop,
        )

    @cached_property
    def workspace(self) -> Workspace:
        """Workspace of the user."""
        return Workspace(self.chain, self.ranges, self.probe.length)

    @cached_property
    def population(self) -> Population:
        """Population of machines."""
        return self.errors or Population(self.chain)

    @property
    def rotary(self) -> Array:
        """Smallest and largest readings of the rotary axes, (R, 2), rad."""
        limits = [self.workspace.limit(name) for name in self.chain.rotary_axes]
        return np.array(limits).reshape(-1, 2)
