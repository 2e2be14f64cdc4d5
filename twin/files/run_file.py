"""Reader of run files (CSV with a TOML head in comments, format "run/1"): measurements."""

from dataclasses import replace
from datetime import UTC, date, datetime
from pathlib import Path

import numpy as np
from pydantic import Field

from matstd.twin.errors import BadFile, BadValue
from matstd.twin.files import run_columns as columns
from matstd.twin.files.keys import Table, checked
from matstd.twin.files.machine_file import Coordinate, Vector, read_machine
from matstd.twin.files.pose_file import FARTHEST, reading_columns, readings
from matstd.twin.files.run_checks import checked_run, states_readings
from matstd.twin.files.table import CsvTable
from matstd.twin.files.toml import parse_kind, read_text
from matstd.twin.frames import IntArray, fixed_xyz, pose
from matstd.twin.machine import Chain
from matstd.twin.record import (
    BODY,
    Instrument,
    Moved,
    Run,
    Setup,
    StatedBody,
    Touches,
    aligned,
    computed_deviation,
    with_body,
)
from matstd.twin.units import DEG, UM

Day = datetime | date
SOME_DAY = date(2031, 5, 6)

_HEAD = (
    'a head that begins with # format = "run/1"; matstd import makes a run file of a table of '
    "measurements"
)

_OPTIONAL = (
    "feature",
    "setup",
    "pose",
    "time_s",
    "repeat",
    "u_um",
    "spindle_rpm",
    "split",
    "dev_um",
    *columns.TARGET,
    columns.RADIUS,
    *columns.PROGRAM,
)


class ProbeTable(Table):
    """`probe`: radius of the ball, length from the gauge point to its centre, and how far it stands
    beside the tool axis, mm.
    """  # noqa: D205

    radius_mm: float = Field(ge=0.0, le=FARTHEST, examples=[3.0])
    """radius of the ball; 0 for an instrument without one"""
    length_mm: float = Field(ge=0.0, le=FARTHEST, examples=[160.0])
    """distance from gauge point to ball centre"""
    offset_mm: tuple[Coordinate, Coordinate] = Field(default=(0.0, 0.0), strict=False)
    """offset of ball centre, or reflector, from the tool axis: x and y of the tool frame"""


class SetupTable(Table):
    """`[setup.a]`: pose of the standard in the table frame."""

    origin_mm: Vector = (0.0, 0.0, 0.0)
    """origin of the artefact frame in the table frame"""
    rotation_deg: Vector = (0.0, 0.0, 0.0)
    """rotations about the fixed x, then y, then z of the table frame"""
    fixing_mm: Vector | None = None
    """point at which the standard is held, artefact frame: it expands from there. Default: by its
    stated temperature from the origin of the artefact frame, by that of a sensor together with the
    table from the origin of the table frame"""
    run: str = ""
    """run that this set-up belongs to, if a file holds several (years, days); the diagnosis
    reports what changed between them"""

    def setup(self, name: str) -> Setup:
        """The set-up in base units."""
        rotation = fixed_xyz(np.array(self.rotation_deg) * DEG)
        place = pose(rotation, np.array(self.origin_mm))
        return Setup(name, place, self.run, fixing=self.fixing_mm)


class BodyTable(Table):
    """`standard`: what the calibrated piece expands by, and how its temperature is known."""

    expansion_1_K: float = Field(examples=[11.5e-6])  # noqa: N815  (K is the kelvin)
    """coefficient of expansion α, 1/K"""
    expansion_u_1_K: float | None = None  # noqa: N815
    """its standard uncertainty. Default: a tenth of α (JCGM 100:2008, H.1.3.3: steel 11.5e-6
    within ± 2e-6, rectangular)"""
    body_degC: float | None = None  # noqa: N815
    """temperature of the standard, 0 to 50 °C. A column `T_body_degC` states it touch by touch and
    takes precedence; a difference of more than 2 u between both is refused"""
    body_u_K: float | None = None  # noqa: N815
    """its standard uncertainty, one error common to all touches. Default: 0.3 K for a stated
    temperature, otherwise 2 K"""
    scale_u_ppm: float | None = Field(default=None, examples=[5.3])
    """relative standard uncertainty of the calibrated lengths at 20 °C, one error common to all
    features: scales and temperature of the CMM. `matstd evaluate` takes it from the calibrated
    standard. Default: 0"""


class HeadTable(Table):
    """The head of a run file."""

    format: str = Field(examples=["run/1"])
    """kind and version of the file, `"run/1"`"""
    machine: str = Field(examples=["machine.toml"])
    """path of the machine file, relative to this file"""
    probe: ProbeTable
    """ball and length of the probe, `probe = { radius_mm = 3.0, length_mm = 160.0 }`"""
    instrument: Instrument = Field(default=Instrument.TOUCH_PROBE, strict=False)
    """instrument: `touch-probe`, `laser`, `tracker`, `dial-gauge`, `encoder`, `cmm`, `ball-bar`,
    `autocollimator`; effects of probe and standard are searched only for a touch probe. An
    autocollimator (or any instrument for angles) measures no displacement: `dev_um` is the angular
    deviation of the table, seen from the tool, about p × n, times the length of p (1000 mm: µrad
    become µm)"""
    u_um: float | None = Field(default=None, ge=columns.FINEST, le=columns.COARSEST)
    """standard uncertainty of one touch, µm: repeatability and calibration of the standard.
    Required here or as a column"""
    standard: BodyTable | None = None
    """expansion and temperature of the calibrated piece, the table below; for a touch probe"""
    date: Day | None = Field(default=None, examples=[SOME_DAY])
    """date, or date and time, at which the run began; with a time zone it is taken as UTC.
    `matstd evaluate` takes it from the logs; `matstd trend` orders runs by it"""
    stamp: str = Field(default="", examples=["FFS-600U 001 7A09B49B2AF2"])
    """name, serial number and digest of the probed standard, as `matstd evaluate` writes it;
    `matstd trend` refuses runs of several standards"""
    setup: dict[str, SetupTable] = Field(default_factory=dict)
    """one table `[setup.NAME]` for every position of the standard. Default: one at the origin of
    the table frame"""


def read_run(path: str | Path, chain: Chain | None = None) -> Run:
    """Measurements from a run file, on the machine that its head names or another; raises BadFile.

    Faults that can be corrected without guessing are corrected and reported in `Run.remarks`;
    others are refused.
    """
    text = read_text(path)
    head_text, body, first = _split_head(text, path)
    head = checked(HeadTable, parse_kind(head_text, path, "run/1", whole=text), path)
    if chain is None:
        chain = read_machine(head.machine, named_in=path)
    table = CsvTable(body, path, first)
    _check_columns(table, chain)
    if not len(table):
        raise BadFile(path, "table", "no rows", "one row per touch")
    remarks = list(chain.remarks)
    columns.put_in_order(table, remarks)
    stated = _assemble(table, chain, head, remarks)
    if head.standard is not None:
        stated = _with_body(stated, head.standard, table)
    run = stated
    moved: tuple[Moved, ...] = ()
    if "dev_um" not in table:
        run, moved = aligned(stated)
    elif states_readings(stated):
        placed, moved = aligned(stated)
        run = replace(placed, deviation=stated.deviation)
    remarks += [columns.moved_setup_remark(m) for m in moved]
    if head.instrument.reads_angle:
        remarks.append(columns.angle_remark(stated.touches.point))
    try:
        run = checked_run(run, table, remarks)
    except BadFile as refusal:
        refusal.facts["run"] = stated  # for callers that search for the mistake
        raise
    return replace(run, remarks=tuple(remarks), date=_began(head.date), standard=head.stamp)


def _began(stated: date | None) -> datetime | None:
    """A date as a time without a zone."""
    if stated is None:
        return None
    if not isinstance(stated, datetime):
        return datetime(stated.year, stated.month, stated.day)
    return stated if stated.tzinfo is None else stated.astimezone(UTC).replace(tzinfo=None)


def _with_body(run: Run, stated: BodyTable, table: CsvTable) -> Run:
    """The run with the growth of its standard taken off; raises BadFile."""
    column = f"T_{BODY}_degC"
    if column in table and BODY not in run.touches.temperature:
        values, gaps = table.temperatures(column)
        row = int(np.argmax(gaps))
        raise table.bad(
            row, column, f"{values[row]:g}", "the temperature of the standard in degC (not kelvin)"
        )
    try:
        return with_body(run, StatedBody(**stated.model_dump()))
    except BadValue as error:
        within = "" if error.facts["key"] == column else "standard"
        raise BadFile.of(table.path, error, within) from None


def _split_head(text: str, path: str | Path) -> tuple[str, str, int]:
    """Head without its comment signs, table, and the line on which the table begins."""
    lines = text.splitlines()
    n = 0
    while n < len(lines) and (lines[n].startswith("#") or not lines[n].strip()):
        n += 1
    head = "\n".join(line.removeprefix("#").removeprefix(" ") for line in lines[:n])
    if not head.strip():
        found = f"{lines[n][:40]!r}" if n < len(lines) else "an empty file"
        if found.startswith("'MATSTD LOG"):
            expected = "a run file (matstd evaluate makes one of it)"
            raise BadFile(path, n + 1, "the log of a probing program", expected)
        raise BadFile(path, n + 1, found, _HEAD)
    return head, "\n".join(lines[n:]), n + 1


def _check_columns(table: CsvTable, chain: Chain) -> None:
    """Required columns are present, and no unknown ones."""
    columns.check_units(table)
    names = [column for column, _ in reading_columns(chain).values()]
    directions = [f"dir{axis}" for axis in chain.axes]
    sensors = [c for c in table.columns if columns.SENSOR.match(c) or columns.OWN.match(c)]
    known = [*names, *columns.POINT, *columns.NORMAL, *_OPTIONAL, *columns.FORCE]
    table.allow_only([*known, *directions, *sensors], " or T_<sensor>_degC or V_<name>_<unit>")
    needed = [reading_columns(chain)[axis][0] for axis in chain.programmed_axes]
    table.require([*needed, *columns.POINT, *columns.NORMAL])


def _assemble(table: CsvTable, chain: Chain, head: HeadTable, remarks: list[str]) -> Run:
    """Run of all rows."""
    n = len(table)
    q = readings(table, chain)
    setups, setup = _setups(table, head)
    time = columns.times(table)
    probe = head.probe
    target = columns.targets(table, (*probe.offset_mm, -probe.length_mm))
    touches = Touches(
        chain=chain,
        q=q,
        length=-target[:, 2],
        offset=target[:, :2],
        radius=columns.radii(table, head.probe.radius_mm),
        instrument=head.instrument,
        point=columns.points(table),
        normal=columns.normals(table, remarks),
        setups=setups,
        setup=setup,
        time=time,
        approach=np.zeros(q.shape),
        temperature=columns.temperatures(table, time, remarks),
        spindle_rpm=table.numbers("spindle_rpm") if "spindle_rpm" in table else None,
        force=columns.force(table),
        feature=np.array(table.text("feature") if "feature" in table else [""] * n),
        pose=columns.poses(table, chain, q, setup),
        value=columns.own_columns(table, time, remarks),
    )
    # implied directions need the normals and set-ups of the touches, so they come second
    signs = columns.approach(table, touches)
    if not head.instrument.is_ball_on_standard:
        signs = columns.standing(table, signs, touches, remarks)
    touches = replace(touches, approach=signs)
    return Run(
        touches=touches,
        deviation=table.numbers("dev_um") * UM
        if "dev_um" in table
        else computed_deviation(touches),
        u=columns.uncertainties(table, head.u_um),
        split=columns.splits(table),
        repeat=columns.counted(table, "repeat") if "repeat" in table else None,
        line=np.array(table.lines),
        program=np.array(table.text("program") if "program" in table else [""] * n),
        touch=columns.counted(table, "touch"),
        program_line=columns.counted(table, "program_line"),
    )


def _setups(table: CsvTable, head: HeadTable) -> tuple[tuple[Setup, ...], IntArray]:
    """Set-ups in the order of the head, and the index of every row's."""
    tables = head.setup or {"a": SetupTable()}
    setups = tuple(entry.setup(name) for name, entry in tables.items())
    names = list(tables)
    if "setup" not in table:
        if len(names) > 1:
            found = "several set-ups in the head and no column setup"
            raise BadFile(table.path, table.header_line, found, "a column setup")
        return setups, np.zeros(len(table), dtype=np.int64)
    index = np.zeros(len(table), dtype=np.int64)
    for i, name in enumerate(table.text("setup")):
        if name not in names:
            raise table.bad(i, "setup", repr(name), f"one of {', '.join(names)} as in the head")
        index[i] = names.index(name)
    return setups, index
