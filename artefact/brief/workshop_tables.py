"""Tables of a project file on the workshop: probe, table, clamps, control.

Contradictory bodies and impossible probes are rejected before any work is done.
"""

import re
import tomllib
from collections.abc import Collection, Mapping
from functools import cache
from importlib.resources import files
from pathlib import Path
from typing import Literal, TypeVar

import numpy as np
from pydantic import Field

from matstd.artefact.brief.brief import ProgramSettings
from matstd.artefact.reach import TABLE, Body, DatumBall, Solid, read_drawn_body
from matstd.artefact.tool import Probe
from matstd.twin.errors import BadFile
from matstd.twin.files import Pair, Table, Vector
from matstd.twin.units import DEG, UM

Cylinders = tuple[tuple[float, float], ...]  # (end, diameter) from the ball centre upwards, mm


class ProbeTable(Table):
    """`[probe]`: the ball, its distance from the gauge point, and the bodies above it.

    The shape is stated by stylus and body, by a stack of cylinders or by a model of the library.
    """

    model: str | None = None
    """name in the library; radius, length and shape are those of the library unless given"""
    radius_mm: float | None = Field(default=None, ge=0.05, le=25.0, examples=[3.0])
    """radius of the ball; required without a model"""
    length_mm: float | None = Field(default=None, gt=0.0, examples=[160.0])
    """distance from gauge point to ball centre; required without a model"""
    stack_mm: list[Pair] | None = Field(default=None, examples=[[[50.0, 4.0], [160.0, 60.0]]])
    """`[[end, diameter], ...]` of its cylinders from the ball centre upwards; the last extends to
    the gauge line"""
    stylus_length_mm: float | None = Field(default=None, gt=0.0, examples=[50.0])
    """distance from ball centre to the body of the probe. Default: half the length"""
    stylus_diameter_mm: float | None = Field(default=None, gt=0.0, examples=[4.0])
    """diameter of the stem. Default: that of a common stylus for the ball"""
    body_diameter_mm: float = Field(default=50.0, gt=0.0)
    """diameter of the probe body, up to the gauge line"""
    nose_diameter_mm: float | None = Field(default=None, gt=0.0, examples=[90.0])
    """diameter of spindle nose or ram up to 150 mm above the gauge line, as measured. A table that
    swivels comes beside it. Default: that of the model, or 90 mm; the set-up sheet says so"""

    def probe(self) -> Probe:
        """In base units; requires the complete table of `checked_probe`."""
        assert self.radius_mm is not None
        assert self.length_mm is not None
        nose, likely = self.nose_diameter_mm, probe_models()[self.model or "plain"]
        return Probe(
            radius=self.radius_mm,
            length=self.length_mm,
            stack=tuple((end, 0.5 * diameter) for end, diameter in self.stack_mm or ()),
            nose_radius=0.5 * (nose or likely.nose_diameter_mm),
            nose_is_stated=nose is not None,
        )


class ModelTable(Table):
    """A probe of the library."""

    source: str
    """source of the figures"""
    ball_diameter_mm: float = Field(gt=0.0)
    """diameter of the ball"""
    stack_mm: list[Pair]
    """cylinders from the ball centre upwards"""
    nose_diameter_mm: float = Field(gt=0.0)
    """diameter of the spindle nose above the gauge line"""


class TableTable(Table):
    """`[workshop.table]`: its face, round or square."""

    diameter_mm: float | None = Field(default=None, gt=0.0, examples=[320.0])
    """diameter of a round face"""
    sides_mm: Pair | None = Field(default=None, examples=[[400.0, 300.0]])
    """sides of a rectangular face"""
    height_mm: float = 0.0
    """height of the face above the origin of the table frame"""
    thickness_mm: float = Field(default=60.0, gt=0.0)
    """thickness of the table below the face, kept clear"""

    def solid(self) -> Solid:
        """The table as a body."""
        a, b = self.sides_mm or (self.diameter_mm or 0.0,) * 2
        return Solid(
            TABLE,
            (0.5 * a, 0.5 * b),
            self.sides_mm is None,
            self.height_mm - self.thickness_mm,
            self.height_mm,
        )


class BodyTable(Table):
    """`[[workshop.bodies]]`: clamp, fixture or cover, in the frame of the table's face.

    Its z points out of the face. Its x and y are those of the table where the face looks along z,
    z and x of the table where it looks along y, y and z where it looks along x; y is reversed
    where it looks the opposite way.
    With `setup` it stands there only in that set-up.
    """

    name: str = Field(pattern=r"^[A-Za-z0-9_.+-]{1,13}$", examples=["CLAMP"])
    """up to 13 letters, digits, `_ . + -`"""
    at_mm: Vector = (0.0, 0.0, 0.0)
    """centre of its lower side; origin of an STL"""
    sides_mm: Pair | None = Field(default=None, examples=[[60.0, 40.0]])
    """sides of a box"""
    diameter_mm: float | None = Field(default=None, gt=0.0, examples=[40.0])
    """diameter of an upright cylinder"""
    height_mm: float | None = Field(default=None, gt=0.0, examples=[50.0])
    """height of box or cylinder"""
    stl: str | None = Field(default=None, examples=["clamp.stl"])
    """mesh file, mm, relative to this file"""
    turned_deg: float = 0.0
    """rotation about its own upright axis"""
    on: str = ""
    """axis that carries it, `"B"` for the cradle of a trunnion; empty if it moves with the
    table"""
    setup: str = ""
    """set-up in which it is present; empty for all"""

    def body(self, folder: Path) -> Body:
        """In base units, a mesh read from a folder; raises BadFile for none, or an empty one."""
        a, b = self.sides_mm or (self.diameter_mm or 0.0,) * 2
        return Body(
            name=self.name,
            at=self.at_mm,
            half_size=(0.5 * a, 0.5 * b),
            is_disc=self.sides_mm is None,
            height=self.height_mm or 0.0,
            turn=self.turned_deg * DEG,
            on=self.on,
            setup=self.setup,
            drawn=None if self.stl is None else read_drawn_body(folder / self.stl),
        )


class BallTable(Table):
    """`[workshop.ball]`: a calibrated ball on the table that monitors the probe."""

    at_mm: Vector = Field(examples=[[120.0, 0.0, 60.0]])
    """its centre, in the frame of the table's face"""
    diameter_mm: float = Field(gt=0.0, le=100.0, examples=[25.0])
    """calibrated diameter"""
    stem_diameter_mm: float = Field(gt=0.0, examples=[10.0])
    """diameter of the upright stem down to the table's face"""
    u_um: float = Field(default=0.5, ge=0.0, le=100.0)
    """standard uncertainty of the diameter, µm"""

    def ball(self, low: float) -> DatumBall:
        """The ball on a stem that begins at height `low`, mm."""
        size = (0.5 * self.diameter_mm, 0.5 * self.stem_diameter_mm)
        return DatumBall(*self.at_mm, *size, low, 0.5 * self.u_um * UM)


class TemperatureTable(Table):
    """`[workshop.temperatures]`: a sensor whose reading the PLC passes to programs."""

    parameter: int = Field(ge=100, le=107, examples=[100])
    """number of the Q parameter"""
    factor: float = 1.0
    """°C per unit of the parameter"""
    offset: float = 0.0
    """°C at zero"""


AnyProbe = TypeVar("AnyProbe", bound=ProbeTable)


class FurtherProbeTable(ProbeTable):
    """`[[workshop.probes]]`: a probe with its own tool number for touches that others miss."""

    tool: int = Field(ge=1, le=32767, examples=[31])
    """its number in the tool table, different from all other probes"""


class WorkshopTable(Table):
    """`[workshop]`: bodies on the machine, and its control."""

    table: TableTable | None = None
    """face of the table. Default: a disc of `limits.table_radius_mm`"""
    bodies: list[BodyTable] = Field(default_factory=list)
    """clamps, fixtures, covers, `[[workshop.bodies]]`"""
    probes: list[FurtherProbeTable] = Field(default_factory=list)
    """further probes, `[[workshop.probes]]`, for touches that the previous ones do not reach"""
    tool: int = Field(default=30, ge=1, le=32767)
    """number of the probe in the tool table"""
    preset: int = Field(default=1, ge=0, le=999)
    """row of the preset table"""
    folder: str = Field(default="TNC:\\MATSTD", pattern=r"^[A-Z0-9_:\\.-]{1,40}$")
    """folder of programs, masks and logs on the control"""
    clearance_mm: float = Field(default=20.0, ge=1.0)
    """clearance of the tool above everything during sideways moves"""
    retract_mm: float = Field(default=1.0, ge=0.0, le=20.0)
    """distance below the upper end of Z at which rotary axes turn"""
    probing_feed_mm_min: int = Field(default=250, ge=10, le=1000)
    """feed of cycle 4; use the same for the calibration of the probe"""
    approach_feed_mm_min: int = Field(default=2000, ge=100, le=5000)
    """feed below the clearance height"""
    turning_feed_deg_min: int = Field(default=1000, ge=100, le=5000)
    """feed of the last motion to a rotary position"""
    touches_per_file: int = Field(default=400, ge=10)
    """touches after which the next visit starts a new program"""
    minutes_per_file: float | None = Field(default=None, ge=1.0, examples=[20.0])
    """largest duration of a program, unless one visit takes longer"""
    dry_run_mm: float = Field(default=100.0, ge=10.0)
    """height of the dry run above the programs"""
    height_read: Literal["gauge", "tip"] = "gauge"
    """height that Z of cycle 4 refers to: the spindle's `gauge` point or the `tip`"""
    ball: BallTable | None = None
    """calibrated ball beside the standard, `[workshop.ball]`"""
    temperatures: dict[str, TemperatureTable] = Field(default_factory=dict)
    """sensors of the control, `[workshop.temperatures]`"""
    strategy: Literal["axes", "plane-spatial"] = "axes"
    """`"axes"`: readings of the axes, coordinates from our own kinematics; `"plane-spatial"`:
    coordinates of planes that the control tilts with the table
    ([controls](../controls.md#tilted-planes))"""

    def settings(self, control: str) -> ProgramSettings:
        """Settings of programs; keys that the file leaves out are left to the dialect."""
        stated = self.model_fields_set
        return ProgramSettings(
            control=control,
            folder=self.folder if "folder" in stated else None,
            tool=self.tool if "tool" in stated else None,
            further_tools=tuple(probe.tool for probe in self.probes),
            preset=self.preset if "preset" in stated else None,
            height_read=self.height_read if "height_read" in stated else None,
            clearance=self.clearance_mm,
            retract=self.retract_mm,
            probing_feed=float(self.probing_feed_mm_min),
            approach_feed=float(self.approach_feed_mm_min),
            turning_feed=float(self.turning_feed_deg_min),
            touches_per_file=self.touches_per_file,
            minutes_per_file=self.minutes_per_file or np.inf,
            dry_run=self.dry_run_mm,
            planes=self.strategy == "plane-spatial",
            temperatures={
                name: (one.parameter, one.factor, one.offset)
                for name, one in self.temperatures.items()
            },
        )


@cache
def probe_models() -> dict[str, ModelTable]:
    """The library of common probes, by name."""
    text = files("matstd.artefact.brief").joinpath("probes.toml").read_text(encoding="utf-8")
    return {name: ModelTable.model_validate(keys) for name, keys in tomllib.loads(text).items()}


def checked_probe(probe: AnyProbe, path: Path, key: str = "probe") -> AnyProbe:
    """The probe with all values that follow from its model or from defaults.

    Raises:
        BadFile: An unknown model, no radius or length, a stack that does not rise or
            ends beyond the gauge line, a stylus that is not thinner than the ball.
    """
    given = probe.model_fields_set
    shaped = {"stack_mm", "stylus_length_mm", "stylus_diameter_mm", "body_diameter_mm"}
    ways = [given & {"model"}, given & {"stack_mm"}, given & (shaped - {"stack_mm"})]
    if sum(map(bool, ways)) > 1:
        found = ", ".join(sorted(given & (shaped | {"model"})))
        raise BadFile(path, key, found, "its shape by model, by stack_mm or by stylus and body")
    stated = {"radius_mm": probe.radius_mm, "length_mm": probe.length_mm}
    stack = probe.stack_mm
    if probe.model is not None:
        known = probe_models()
        if probe.model not in known:
            raise BadFile(path, f"{key}.model", repr(probe.model), "one of " + ", ".join(known))
        model = known[probe.model]
        stack = model.stack_mm
        stated["radius_mm"] = probe.radius_mm or 0.5 * model.ball_diameter_mm
        stated["length_mm"] = probe.length_mm or stack[-1][0]
    radius, length = stated["radius_mm"], stated["length_mm"]
    for name in ("radius_mm", "length_mm"):
        if stated[name] is None:
            raise BadFile(path, f"{key}.{name}", "nothing", "a number, or a model of the library")
    assert radius is not None
    assert length is not None
    stack = _plain(probe, radius, length, path, key) if stack is None else list(stack)
    if stack[-1][0] < length:
        stack.append((length, stack[-1][1]))
    ends = [end for end, _ in stack]
    if ends != sorted(set(ends)) or not radius < ends[0] or ends[-1] > length:
        expected = f"ends that rise from radius_mm = {radius:g} to length_mm = {length:g} at most"
        raise BadFile(path, f"{key}.stack_mm", ends, expected)
    if not all(d > 0.0 for _, d in stack) or stack[0][1] >= 2.0 * radius:
        name = "stylus_diameter_mm" if given & {"stylus_diameter_mm"} else "stack_mm"
        worst = stack[0][1] if stack[0][1] >= 2.0 * radius else min(d for _, d in stack)
        expected = f"less than the ball, {2.0 * radius:g}, for the stylus, and above zero for all"
        raise BadFile(path, f"{key}.{name}", f"{worst:g}", expected)
    return probe.model_copy(update={**stated, "stack_mm": stack})


def _plain(probe: ProbeTable, radius: float, length: float, path: Path, key: str) -> list[Pair]:
    """Stylus and body; the stylus half the length and two thirds of the ball where not given."""
    end = 0.5 * length if probe.stylus_length_mm is None else probe.stylus_length_mm
    if not radius < end < length:
        expected = f"between radius_mm = {radius:g} and length_mm = {length:g}"
        raise BadFile(path, f"{key}.stylus_length_mm", f"{end:g}", expected)
    diameter = probe.stylus_diameter_mm or 2.0 * (radius * 2.0 / 3.0)
    return [(end, diameter), (length, probe.body_diameter_mm)]


def checked_probes(workshop: WorkshopTable, path: Path) -> tuple[FurtherProbeTable, ...]:
    """The further probes, completed, each with its own tool number.

    Raises:
        BadFile: As of `checked_probe`; a tool number that is used twice.
    """
    tools, out = [workshop.tool], []
    for i, probe in enumerate(workshop.probes):
        key = f"workshop.probes.{i}"
        if probe.tool in tools:
            raise BadFile(path, f"{key}.tool", probe.tool, "a number that no other probe has")
        tools.append(probe.tool)
        out.append(checked_probe(probe, path, key))
    return tuple(out)


def check_workshop(workshop: WorkshopTable, setups: Collection[str], path: Path) -> None:
    """Raise BadFile for a table or body without exactly one shape, or in an unknown set-up."""
    table = workshop.table
    if table is not None and (table.diameter_mm is None) == (table.sides_mm is None):
        raise BadFile(path, "workshop.table", "not one outline", "diameter_mm or sides_mm")
    _check_temperatures(workshop.temperatures, path)
    _check_ball(workshop, path)
    names = [body.name for body in workshop.bodies]
    for i, body in enumerate(workshop.bodies):
        where = f"workshop.bodies.{i}"
        outlines = [body.sides_mm, body.diameter_mm, body.stl]
        if sum(outline is not None for outline in outlines) != 1:
            raise BadFile(path, where, "not one shape", "sides_mm, diameter_mm or stl")
        if (body.stl is None) != (body.height_mm is not None):
            expected = "a height with sides_mm or diameter_mm, and none with stl"
            raise BadFile(path, f"{where}.height_mm", repr(body.height_mm), expected)
        if body.sides_mm is not None and min(body.sides_mm) <= 0.0:
            raise BadFile(path, f"{where}.sides_mm", list(body.sides_mm), "positive sides")
        if body.name in names[:i] or body.name in ("TABLE", "DATUM", "DATUM.STEM"):
            raise BadFile(path, f"{where}.name", repr(body.name), "a name of its own")
        if body.setup and body.setup not in setups:
            expected = f"a set-up of the project: {', '.join(setups)}"
            raise BadFile(path, f"{where}.setup", repr(body.setup), expected)


def _check_ball(workshop: WorkshopTable, path: Path) -> None:
    """The ball must stand on a thinner stem, above the table."""
    ball, table = workshop.ball, workshop.table
    if ball is None:
        return
    if ball.stem_diameter_mm >= ball.diameter_mm:
        expected = f"less than the ball, {ball.diameter_mm:g}"
        found = f"{ball.stem_diameter_mm:g}"
        raise BadFile(path, "workshop.ball.stem_diameter_mm", found, expected)
    lowest = (0.0 if table is None else table.height_mm) + 0.5 * ball.diameter_mm
    if not ball.at_mm[2] > lowest:
        raise BadFile(path, "workshop.ball.at_mm", list(ball.at_mm), f"more than {lowest:g} in z")


def _check_temperatures(sensors: Mapping[str, TemperatureTable], path: Path) -> None:
    """Names must suit a column, and every sensor needs its own parameter."""
    for name, sensor in sensors.items():
        key = f"workshop.temperatures.{name}"
        if not re.fullmatch(r"[A-Za-z0-9_]{1,16}", name):
            raise BadFile(path, key, repr(name), "1 to 16 letters, digits or _")
        if not 1e-6 <= abs(sensor.factor) <= 1e3:
            raise BadFile(path, f"{key}.factor", f"{sensor.factor:g}", "0.000001 to 1000")
        others = [n for n, s in sensors.items() if s.parameter == sensor.parameter]
        if len(others) > 1:
            expected = f"a parameter for each of {', '.join(others)}"
            raise BadFile(path, f"{key}.parameter", sensor.parameter, expected)
