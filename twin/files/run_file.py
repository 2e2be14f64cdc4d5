"""Reader of run files (CSV with a TOML head in comments, format "run/1"): measurements."""

from dataclasses import replace
from pathlib import Path

import numpy as np
from pydantic import Field

from matstd.twin.errors import BadFile, BadValue
from matstd.twin.files import run_columns as columns
from matstd.twin.files.machine_file import Coordinate, Vector, read_machine
from matstd.twin.files.pose_file import FARTHEST, reading_columns, readings
from matstd.twin.files.run_checks import checked_run, states_readings
from matstd.twin.files.table import CsvTable
from matstd.twin.files.toml import Table, check_format, checked, is_file, parse_toml, read_text
from matstd.twin.frames import fixed_xyz, pose
from matstd.twin.machine import Chain
from matstd.twin.record import (
    BODY,
    Instrument,
    IntArray,
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
)


class ProbeTable(Table):
    """`probe`: radius of the ball, length from the gauge point to its centre, and how far it stands
    beside the tool axis, mm.
    """  # noqa: D205

    radius_mm: float = Field(ge=0.0, le=FARTHEST)
    length_mm: float = Field(ge=0.0, le=FARTHEST)
    offset_mm: tuple[Coordinate, Coordinate] = Field(default=(0.0, 0.0), strict=False)


class SetupTable(Table):
    """`[setup.a]`: pose of the standard in the table frame."""

    origin_mm: Vector = (0.0, 0.0, 0.0)
    rotation_deg: Vector = (0.0, 0.0, 0.0)
    run: str = ""

    def setup(self, name: str) -> Setup:
        """The set-up in base units."""
        rotation = fixed_xyz(np.array(self.rotation_deg) * DEG)
        return Setup(name, pose(rotation, np.array(self.origin_mm)), self.run)


class BodyTable(Table):
    """`standard`: what the calibrated piece expands by, and how its temperature is known."""

    expansion_1_K: float  # noqa: N815  (K is the kelvin)
    expansion_u_1_K: float | None = None  # noqa: N815
    body_degC: float | None = None  # noqa: N815
    body_u_K: float | None = None  # noqa: N815
    scale_u_ppm: float | None = None


class HeadTable(Table):
    """The head of a run file."""

    format: str
    machine: str
    probe: ProbeTable
    instrument: Instrument = Field(default=Instrument.TOUCH_PROBE, strict=False)
    u_um: float | None = Field(default=None, ge=columns.FINEST, le=columns.COARSEST)
    standard: BodyTable | None = None
    setup: dict[str, SetupTable] = Field(default_factory=dict)


def read_run(path: str | Path, chain: Chain | None = None) -> Run:
    """Measurements from a run file; raises BadFile.

    Faults that can be corrected without guessing are corrected and reported in `Run.remarks`;
    others are refused.

    Args:
        chain: The machine; None reads the machine file that the head names.
    """
    text = read_text(path)
    head_text, body, first = _split_head(text, path)
    data = parse_toml(head_text, path)
    check_format(data, "run/1", path)
    head = checked(HeadTable, data, path)
    if chain is None:
        chain = _machine(path, head.machine)
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
    return replace(run, remarks=tuple(remarks))


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
            raise BadFile(path, f"line {n + 1}", "the log of a probing program", expected)
        raise BadFile(path, f"line {n + 1}", found, 'a head that begins with # format = "run/1"')
    return head, "\n".join(lines[n:]), n + 1


def _machine(path: str | Path, named: str) -> Chain:
    """The machine that the head of a run file names, by a path relative to that file."""
    place = Path(path).parent / named
    if not is_file(place):
        found = f"{named!r}, and {place} is no file"
        raise BadFile(path, "machine", found, "the path of a machine file, relative to this file")
    return read_machine(place)


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
        repeat=columns.repeats(table),
        line=np.array(table.lines),
    )


def _setups(table: CsvTable, head: HeadTable) -> tuple[tuple[Setup, ...], IntArray]:
    """Set-ups in the order of the head, and the index of every row's."""
    tables = head.setup or {"a": SetupTable()}
    setups = tuple(entry.setup(name) for name, entry in tables.items())
    names = list(tables)
    if "setup" not in table:
        if len(names) > 1:
            raise BadFile(
                table.path,
                f"line {table.header_line}",
                "several set-ups in the head and no column setup",
                "a column setup",
            )
        return setups, np.zeros(len(table), dtype=np.int64)
    index = np.zeros(len(table), dtype=np.int64)
    for i, name in enumerate(table.text("setup")):
        if name not in names:
            raise table.bad(i, "setup", repr(name), f"one of {', '.join(names)} as in the head")
        index[i] = names.index(name)
    return setups, index
