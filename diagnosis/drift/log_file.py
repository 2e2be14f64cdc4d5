"""Logs of drift at the border: a table of temperatures, speeds and displacements over time."""

import gzip
from collections.abc import Sequence
from datetime import datetime
from pathlib import Path

import numpy as np

from matstd.diagnosis.drift.record import DriftRecord
from matstd.twin.errors import BadFile
from matstd.twin.files import CsvTable, read_text
from matstd.twin.frames import Array, IntArray
from matstd.twin.units import HOUR, MINUTE, UM, URAD

EPOCH = datetime(2000, 1, 1)
TIMES = {"time_s": 1.0, "time_min": MINUTE, "time_h": HOUR}
ARCSEC = np.pi / 180.0 / 3600.0
DISPLACEMENTS = {
    "_um": ("mm", UM),
    "_mm": ("mm", 1.0),
    "_urad": ("rad", URAD),
    "_mrad": ("rad", 1e-3),
    "_arcsec": ("rad", ARCSEC),
}
"""Endings of columns of displacements, their base unit, and what one of it is in that."""

MAX_BRIDGED = 5.0 * MINUTE  # longest time without a reading that is bridged by a straight line, s
MIN_STRETCH = 20  # steps of the shortest stretch between two gaps that is used

TYPES = "T_name_degC or name_degC, name_rpm, V_name_unit; name_um, _mm, _urad, _mrad, _arcsec"


def read_log(path: str | Path, step: float, needs_displacement: bool = True) -> DriftRecord:
    """A log at equal steps: means over every step, short gaps bridged, long ones parting it.

    Args:
        path: CSV, which may be packed (`.gz`): `time_s`, `time_min`, `time_h` or `clock`;
            temperatures `..._degC`, speeds `..._rpm`, own columns `V_...`; displacements with
            their unit at the end.
        step: Wanted, s; a log with slower readings has its own.
        needs_displacement: Whether a log without displacements is refused.

    Raises:
        BadFile: File, line and column, what stood there, what was expected.
    """
    table = CsvTable(_text(path), path)
    time = _time(table)
    remarks: list[str] = []
    drives, displacements = _kinds(table, remarks, needs_displacement)
    values = {name: _values(table, name, remarks) for name in (*drives, *displacements)}
    pace = float(np.median(np.diff(time)))
    step = max(step, pace)
    bins = np.floor((time - time[0]) / step + 1e-9).astype(int)
    data = np.column_stack([values[name] for name in (*drives, *displacements)])
    grid = _binned(data, bins)
    keep, stretch = _stretches(grid, step, remarks)
    units = [DISPLACEMENTS[_ending(d)] for d in displacements]
    return DriftRecord(
        time=(keep + 0.5) * step + time[0],
        stretch=stretch,
        step=step,
        drives=tuple(_drive_name(d) for d in drives),
        drive=_bridged(grid[:, : len(drives)])[keep],
        components=tuple(d.removesuffix(_ending(d)) for d in displacements),
        units=tuple(unit for unit, _ in units),
        displacement=_bridged(grid[:, len(drives) :])[keep] * [factor for _, factor in units],
        remarks=tuple(f"{path}: {remark}" for remark in remarks),
    )


def _text(path: str | Path) -> str:
    """Text of a file, unpacked where its name ends in .gz."""
    if Path(path).suffix != ".gz":
        return read_text(path)
    try:
        return gzip.decompress(Path(path).read_bytes()).decode("utf-8-sig")
    except (OSError, EOFError, UnicodeDecodeError) as error:
        raise BadFile(path, "file", error, "a packed text file (gzip, UTF-8)") from error


def _time(table: CsvTable) -> Array:
    """Time of every row, (N,), s, rising."""
    if len(table) < 2 * MIN_STRETCH:
        found = f"{len(table)} rows"
        raise BadFile(table.path, "table", found, f"{2 * MIN_STRETCH} readings at least")
    name, time = _times(table)
    back = np.flatnonzero(np.diff(time) <= 0.0)
    if len(back):
        row = int(back[0]) + 1
        raise table.bad(row, name, table.text(name)[row], "a later reading in every row")
    return time


def _times(table: CsvTable) -> tuple[str, Array]:
    """The column of time, and the time of every row, (N,), s."""
    name = next((n for n in ("clock", *TIMES) if n in table), "time_s")
    table.require([name])
    return name, _clock(table) if name == "clock" else table.numbers(name) * TIMES[name]


def _clock(table: CsvTable) -> Array:
    """Column `clock` in s since the begin of the year 2000."""
    seconds = []
    for row, cell in enumerate(table.text("clock")):
        try:
            seconds.append((datetime.fromisoformat(cell) - EPOCH).total_seconds())
        except (ValueError, TypeError):
            expected = "local date and time such as 2031-05-06T07:08:09"
            raise table.bad(row, "clock", repr(cell), expected) from None
    return np.array(seconds)


def _kinds(
    table: CsvTable, remarks: list[str], needs_displacement: bool
) -> tuple[list[str], list[str]]:
    """Columns that drive, and columns that are displacements."""
    drives = [c for c in table.columns if c.endswith(("_degC", "_rpm")) or c.startswith("V_")]
    moved = [c for c in table.columns if c not in drives and _ending(c)]
    other = set(table.columns) - {*drives, *moved, *TIMES, "clock"}
    if other:
        remarks.append(f"not used: column {', '.join(sorted(other))} (expected {TYPES})")
    if not drives:
        columns = ", ".join(table.columns)
        raise BadFile(table.path, "table", f"columns {columns}", f"temperatures: {TYPES}")
    if needs_displacement and not moved:
        columns = ", ".join(table.columns)
        raise BadFile(table.path, "table", f"columns {columns}", f"displacements: {TYPES}")
    return drives, moved if needs_displacement else []


def _ending(column: str) -> str:
    """Unit at the end of the name of a displacement, "" of other columns."""
    return next((e for e in DISPLACEMENTS if column.endswith(e) and column != e), "")


def _drive_name(column: str) -> str:
    """`T_spindle_degC` -> `spindle`; speeds and own columns keep their names."""
    return column.removeprefix("T_").removesuffix("_degC")


def _values(table: CsvTable, name: str, remarks: list[str]) -> Array:
    """A column; missing or absurd values are NaN and reported."""
    if name.endswith("_degC"):
        values, bad = table.temperatures(name)
    else:
        values = table.numbers(name, empty=np.nan, finite=False, largest=np.inf)
        bad = ~np.isfinite(values)
    if bad.all():
        raise BadFile(table.path, f"column {name}", "no reading", "numbers")
    if bad.any():
        line = table.lines[int(np.flatnonzero(bad)[0])]
        remarks.append(f"{name}: {bad.sum()} readings missing or absurd, the first in line {line}")
    return np.where(bad, np.nan, values)


def _binned(data: Array, bins: np.ndarray) -> Array:
    """Means over the steps; NaN where a step has no reading."""
    known = np.isfinite(data)
    out = np.empty((bins[-1] + 1, data.shape[1]))
    for k in range(data.shape[1]):
        weight = np.bincount(bins, known[:, k], len(out))
        total = np.bincount(bins, np.where(known[:, k], data[:, k], 0.0), len(out))
        out[:, k] = np.where(weight > 0, total / np.maximum(weight, 1.0), np.nan)
    return out


def _stretches(grid: Array, step: float, remarks: list[str]) -> tuple[np.ndarray, np.ndarray]:
    """Rows that are used, and the number of the stretch of each."""
    known = np.isfinite(grid).all(axis=1)
    rows = np.flatnonzero(known)
    apart = np.diff(rows) * step
    cuts = np.flatnonzero(apart > max(MAX_BRIDGED, 3.0 * step))
    runs = [
        np.arange(run[0], run[-1] + 1)
        for run in np.split(rows, cuts + 1)
        if len(run) >= MIN_STRETCH
    ]
    if len(cuts):
        remarks.append(
            f"{len(cuts)} gaps, the longest of {apart.max() / MINUTE:.0f} min: the memory of the "
            "machine begins anew after each"
        )
    if not runs:
        return rows, np.zeros(len(rows), dtype=np.int64)
    return np.concatenate(runs), np.repeat(np.arange(len(runs)), [len(r) for r in runs])


def _bridged(grid: Array) -> Array:
    """Steps without a reading, straight between their neighbours."""
    out = grid.copy()
    at = np.arange(len(grid))
    for column in out.T:
        known = np.isfinite(column)
        column[~known] = np.interp(at[~known], at[known], column[known])
    return out


def check_alike(records: Sequence[DriftRecord], paths: Sequence[str | Path]) -> None:
    """Raise BadFile where a log has other columns, or other steps, than the first."""
    first = records[0]
    for path, record in zip(paths[1:], records[1:], strict=True):
        for name in ("drives", "components", "units"):
            own, wanted = getattr(record, name), getattr(first, name)
            if own != wanted:
                expected = f"{', '.join(wanted)} as in {paths[0]}"
                raise BadFile(path, "columns", ", ".join(own) or "none", expected)
        if abs(record.step - first.step) > 0.01 * first.step:
            expected = f"{first.step:g} s between readings as in {paths[0]}"
            raise BadFile(path, "time", f"{record.step:g} s between readings", expected)


def read_probed(path: str | Path, record: DriftRecord) -> tuple[IntArray, Array, Array | None]:
    """Drifts that were probed: rows of a record, their values and standard uncertainties.

    Args:
        path: CSV with the record's kind of time, its components with a unit, and where known
            `u_um`.

    Returns:
        Rows (n,), values (n, K) in base units, uncertainties (n,) in components' sizes or None.

    Raises:
        BadFile: A component is missing, or a probing lies outside the log.
    """
    table = CsvTable(read_text(path), path)
    name, time = _times(table)
    out = np.empty((len(table), len(record.components)))
    for k, component in enumerate(record.components):
        endings = [e for e, (unit, _) in DISPLACEMENTS.items() if unit == record.units[k]]
        named = [component + ending for ending in endings]
        column = next((n for n in named if n in table), named[0])
        table.require([column])
        out[:, k] = table.numbers(column) * DISPLACEMENTS[_ending(column)][1]
    rows = np.array([int(np.argmin(np.abs(record.time - t))) for t in time], dtype=np.int64)
    for i, (row, t) in enumerate(zip(rows, time, strict=True)):
        if abs(record.time[row] - t) > record.step:
            raise table.bad(i, name, table.text(name)[i], "a time inside the log")
    u = table.numbers("u_um", smallest=1e-6) if "u_um" in table else None
    return rows, out, u
