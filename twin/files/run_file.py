"""Reader of run files (CSV with a TOML head in comments, format "run/1"): measurements."""

import re
from pathlib import Path

import numpy as np
from pydantic import Field

from twin.chain import Chain
from twin.errors import BadFile
from twin.files.machine_file import Vector, read_machine
from twin.files.pose_file import outside_travel, reading_columns, readings
from twin.files.table import CsvTable
from twin.files.toml import Table, check_format, checked, parse_toml, read_text
from twin.frames import Array, fixed_xyz, pose
from twin.run import Run
from twin.touches import IntArray, Labels, Setup, Touches, computed_deviation, linear_approach
from twin.units import DEG, UM

ABSURD = 10.0
"""Deviations beyond this (mm) are no measurement: units mixed up, or a wrong set-up or probe."""

_SENSOR = re.compile(r"T_(\w+)_degC\Z")
POINT = ("px_mm", "py_mm", "pz_mm")
NORMAL = ("nx", "ny", "nz")
FORCE = ("Fx_N", "Fy_N", "Fz_N")
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
)


class ProbeTable(Table):
    """`probe`: radius of the ball and length from the gauge point to its centre, mm."""

    radius_mm: float = Field(ge=0.0)
    length_mm: float


class SetupTable(Table):
    """`[setup.a]`: pose of the standard in the table frame."""

    origin_mm: Vector = (0.0, 0.0, 0.0)
    rotation_deg: Vector = (0.0, 0.0, 0.0)


class HeadTable(Table):
    """The head of a run file."""

    format: str
    machine: str
    probe: ProbeTable
    u_um: float | None = Field(default=None, gt=0.0)
    setup: dict[str, SetupTable] = Field(default_factory=dict)


def read_run(path: str | Path, chain: Chain | None = None) -> Run:
    """Measurements from a run file.

    What can be put right without guessing is put right and told in `Run.remarks`; what cannot is
    refused.

    Args:
        path: The file.
        chain: The machine; None reads the machine file that the head names.

    Raises:
        BadFile: File, line or key, what stood there, what was expected.
    """
    text = read_text(path)
    head_text, body, first = _split_head(text)
    data = parse_toml(head_text, path)
    check_format(data, "run/1", path)
    head = checked(HeadTable, data, path)
    if chain is None:
        chain = read_machine(Path(path).parent / head.machine)
    table = CsvTable(body, path, first)
    _check_columns(table, chain)
    if not len(table):
        raise BadFile(path, "table", "no rows", "a row a touch")
    remarks: list[str] = []
    run = _assemble(table, chain, head, remarks)
    run = _without_copies(run, remarks)
    _check_deviations(run, table)
    return Run(run.touches, run.deviation, run.u, run.split, run.repeat, run.line, tuple(remarks))


def _split_head(text: str) -> tuple[str, str, int]:
    """Head without its comment signs, table, and the line on which the table begins."""
    lines = text.splitlines()
    n = 0
    while n < len(lines) and (lines[n].startswith("#") or not lines[n].strip()):
        n += 1
    head = "\n".join(line.removeprefix("#").removeprefix(" ") for line in lines[:n])
    return head, "\n".join(lines[n:]), n + 1


def _check_columns(table: CsvTable, chain: Chain) -> None:
    """Needed columns are there, and none that nobody understands."""
    names = [column for column, _ in reading_columns(chain).values()]
    table.require([*(reading_columns(chain)[a][0] for a in chain.programmed_axes)])
    table.require([*POINT, *NORMAL])
    directions = [f"dir{axis}" for axis in chain.axes]
    sensors = [c for c in table.columns if _SENSOR.match(c)]
    known = [*names, *POINT, *NORMAL, *_OPTIONAL, *FORCE, *directions, *sensors]
    table.allow_only(known, " or T_<sensor>_degC")


def _assemble(table: CsvTable, chain: Chain, head: HeadTable, remarks: list[str]) -> Run:
    """Run of all rows."""
    n = len(table)
    q = readings(table, chain)
    beyond = outside_travel(table, chain, q, slack=1e-3)  # a trigger may lie past the limit
    if beyond is not None:
        remarks.append(f"{beyond}; it is used as it stands")
    setups, setup = _setups(table, head)
    normal = _normals(table, remarks)
    touches = Touches(
        chain=chain,
        q=q,
        length=np.full(n, head.probe.length_mm),
        radius=np.full(n, head.probe.radius_mm),
        point=np.stack([table.numbers(c) for c in POINT], axis=-1),
        normal=normal,
        setups=setups,
        setup=setup,
        time=_time(table, remarks),
        approach=np.zeros(q.shape),
        temperature=_temperatures(table, remarks),
        spindle_rpm=table.numbers("spindle_rpm") if "spindle_rpm" in table else None,
        force=_force(table),
        feature=np.array(table.text("feature") if "feature" in table else [""] * n),
        pose=_poses(table, chain, q, setup),
    )
    object.__setattr__(touches, "approach", _approach(table, chain, q, touches.normal_table))
    deviation = table.numbers("dev_um") * UM if "dev_um" in table else computed_deviation(touches)
    return Run(
        touches,
        deviation,
        _uncertainty(table, head),
        _split(table),
        table.numbers("repeat", empty=0.0).astype(np.int64) if "repeat" in table else None,
        np.array(table.lines),
    )


def _setups(table: CsvTable, head: HeadTable) -> tuple[tuple[Setup, ...], IntArray]:
    """Set-ups in the order of the head, and the index of every row's."""
    tables = head.setup or {"a": SetupTable()}
    setups = tuple(
        Setup(name, pose(fixed_xyz(np.array(s.rotation_deg) * DEG), np.array(s.origin_mm)))
        for name, s in tables.items()
    )
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


def _normals(table: CsvTable, remarks: list[str]) -> Array:
    """Unit normals; lengths off by rounding are mended and told, others refused."""
    normal = np.stack([table.numbers(c) for c in NORMAL], axis=-1)
    length = np.linalg.norm(normal, axis=-1)
    off = np.abs(length - 1.0)
    worst = int(np.argmax(off))
    if off[worst] > 0.01:
        raise table.bad(worst, "nx, ny, nz", f"a normal of length {length[worst]:.4g}", "length 1")
    if off[worst] > 1e-5:
        remarks.append(
            f"line {table.lines[worst]}: normal of length {length[worst]:.6f}; "
            "all normals were brought to length 1"
        )
    return normal / length[:, None]


def _time(table: CsvTable, remarks: list[str]) -> Array:
    """Time of every row; a clock that goes back is not used."""
    if "time_s" not in table:
        return np.zeros(len(table))
    time = table.numbers("time_s")
    back = np.flatnonzero(np.diff(time) < 0.0)
    if len(back):
        i = int(back[0])
        remarks.append(
            f"line {table.lines[i + 1]}: time_s goes back from {time[i]:g} to {time[i + 1]:g}; "
            "time is left out, so that no effect of time can be found; everything else is used"
        )
        return np.zeros(len(table))
    return time


def _temperatures(table: CsvTable, remarks: list[str]) -> dict[str, Array]:
    """Temperature of every sensor; one with gaps is left out and told."""
    out = {}
    for column in table.columns:
        match = _SENSOR.match(column)
        if match is None:
            continue
        values = table.numbers(column, finite=False)
        missing = np.flatnonzero(~np.isfinite(values))
        if len(missing):
            remarks.append(
                f"line {table.lines[int(missing[0])]}: {column} has no number in {len(missing)} "
                "rows; the sensor is left out"
            )
            continue
        if np.ptp(values) == 0.0:
            remarks.append(
                f"{column} is constant at {values[0]:g} degC: it cannot explain anything"
            )
        out[match.group(1)] = values
    return out


def _force(table: CsvTable) -> Array | None:
    if not any(c in table for c in FORCE):
        return None
    zero = np.zeros(len(table))
    return np.stack([table.numbers(c) if c in table else zero for c in FORCE], axis=-1)


def _poses(table: CsvTable, chain: Chain, q: Array, setup: IntArray) -> IntArray:
    """Label of every row's table pose: the column, else equal rotary readings and set-up."""
    if "pose" in table:
        return np.unique(table.text("pose"), return_inverse=True)[1].astype(np.int64)
    rotary = [chain.axis_index(a) for a in chain.rotary_axes]
    key = np.column_stack([np.round(q[:, rotary], 6), setup])
    return np.unique(key, axis=0, return_inverse=True)[1].reshape(-1).astype(np.int64)


def _approach(table: CsvTable, chain: Chain, q: Array, normal_table: Array) -> Array:
    """Signs of the last motion of every axis."""
    out = linear_approach(chain, q, normal_table)
    for i, axis in enumerate(chain.axes):
        if f"dir{axis}" in table:
            out[:, i] = np.sign(table.numbers(f"dir{axis}"))
    return out


def _uncertainty(table: CsvTable, head: HeadTable) -> Array:
    """Standard uncertainty of every row: its own, else the head's."""
    if head.u_um is None and "u_um" not in table:
        raise BadFile(table.path, "u_um", "nothing", "the standard uncertainty of one touch in µm")
    fallback = None if head.u_um is None else head.u_um
    if "u_um" not in table:
        return np.full(len(table), fallback) * UM
    u = table.numbers("u_um", empty=fallback)
    if np.any(u <= 0.0):
        row = int(np.argmax(u <= 0.0))
        raise table.bad(row, "u_um", f"{u[row]:g}", "a positive number of µm")
    return u * UM


def _split(table: CsvTable) -> Labels:
    if "split" not in table:
        return np.full(len(table), "", dtype="U5")
    out = table.text("split")
    for i, word in enumerate(out):
        if word not in ("train", "test", ""):
            raise table.bad(i, "split", repr(word), "train or test")
    return np.array(out, dtype="U5")


def _without_copies(run: Run, remarks: list[str]) -> Run:
    """The run without rows that stand twice; replicates differ in their readings or their time."""
    t = run.touches
    key = np.column_stack([t.q, t.point, t.normal, t.setup, t.time, run.deviation])
    first = np.unique(key, axis=0, return_index=True)[1]
    if len(first) == len(run):
        return run
    keep = np.zeros(len(run), dtype=bool)
    keep[first] = True
    line = int(run.line[np.argmin(keep)])
    remarks.append(f"line {line}: {int((~keep).sum())} rows stand twice; the copies are left out")
    return run[keep]


def _check_deviations(run: Run, table: CsvTable) -> None:
    """Refuse what cannot be a deviation of a machine tool."""
    typical = float(np.median(np.abs(run.deviation)))
    if typical > ABSURD:
        where = "column dev_um" if "dev_um" in table else "deviations computed from the readings"
        raise BadFile(
            table.path,
            where,
            f"a typical deviation of {typical:.4g} mm",
            "some µm: units are mixed up, or the set-up, the probe or the machine is another one",
        )
