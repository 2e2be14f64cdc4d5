"""Temperatures and spindle speeds by the clock, interpolated to the touches of a run."""

from dataclasses import dataclass, replace
from datetime import datetime, timedelta
from pathlib import Path

import numpy as np

from matstd.twin.errors import BadFile
from matstd.twin.files.run_columns import SENSOR, temperatures
from matstd.twin.files.table import CsvTable
from matstd.twin.files.toml import read_text
from matstd.twin.frames import Array
from matstd.twin.record import Run, Touches

EPOCH = datetime(2000, 1, 1)
MAX_OUTSIDE_RECORD = 300.0
"""Longest time of a touch outside the record, s; the first or last reading then holds."""


@dataclass(frozen=True, eq=False)
class SensorRecord:
    """Readings of sensors."""

    path: Path
    clock: Array  # of every reading, s since `EPOCH`, (M,), rising
    temperature: dict[str, Array]  # by sensor, each (M,), degC
    # speed from each reading to the next, (M,), 1/min; None where not recorded
    spindle_rpm: Array | None
    remarks: tuple[str, ...]  # on sensors that were left out, or are constant

    def joined(self, run: Run, begin: datetime) -> Run:
        """A run with temperatures and spindle speed at its touches, as of `at_touches`."""
        touches = self.at_touches(run.touches, begin)
        return replace(run, touches=touches, remarks=(*run.remarks, *self.remarks))

    @property
    def begin(self) -> datetime:
        """Clock of the first reading."""
        return EPOCH + timedelta(seconds=float(self.clock[0]))

    def since(self, begin: datetime) -> Array:
        """Time of every reading, (M,), s since `begin`."""
        return self.clock - _seconds(begin)

    def at_touches(self, touches: Touches, begin: datetime) -> Touches:
        """Touches with what the sensors read at their times since `begin`; raises BadFile.

        Temperatures are linear in time between readings, the speed stays until the next one.
        """
        at = _seconds(begin) + touches.time
        first, last = self.clock[0], self.clock[-1]
        if at.min() < first - MAX_OUTSIDE_RECORD or at.max() > last + MAX_OUTSIDE_RECORD:
            raise BadFile(
                self.path, "column clock",
                f"readings from {_words(first)} to {_words(last)}",
                f"readings over the run, {_words(at.min())} to {_words(at.max())}",
            )  # fmt: skip
        values = {s: np.interp(at, self.clock, v) for s, v in self.temperature.items()}
        speed = touches.spindle_rpm
        if self.spindle_rpm is not None:
            reading = np.searchsorted(self.clock, at, side="right") - 1
            speed = self.spindle_rpm[np.maximum(reading, 0)]
        return replace(touches, temperature={**touches.temperature, **values}, spindle_rpm=speed)


def read_sensors(path: str | Path) -> SensorRecord:
    """Read a table with a column `clock` (2031-05-06T07:08:09) and what was recorded.

    That is any number of columns `T_<sensor>_degC`, and `spindle_rpm`, the speed from this reading
    to the next one.

    Raises:
        BadFile: File, line and column, what stood there, what was expected.
    """
    table = CsvTable(read_text(path), path)
    table.require(["clock"])
    if len(table) < 2:
        raise BadFile(path, "table", f"{len(table)} rows", "two readings at least")
    clock = np.empty(len(table))
    for i, cell in enumerate(table.text("clock")):
        try:
            clock[i] = _seconds(datetime.fromisoformat(cell))
        except (ValueError, TypeError):
            expected = "local date and time such as 2031-05-06T07:08:09"
            raise table.bad(i, "clock", repr(cell), expected) from None
        # interpolation needs a rising clock
        if i and clock[i] <= clock[i - 1]:
            raise table.bad(i, "clock", cell, "a later reading in every row")
    remarks: list[str] = []
    found = temperatures(table, clock, remarks)
    used = ("clock", "spindle_rpm")
    others = [c for c in table.columns if c not in used and not SENSOR.match(c)]
    if others:
        remarks.append(
            f"column {', '.join(map(repr, others))} is not used: no T_<sensor>_degC and no "
            "spindle_rpm"
        )
    speed = table.numbers("spindle_rpm") if "spindle_rpm" in table else None
    if not found and speed is None:
        found_words = "; ".join(remarks) or f"columns {', '.join(table.columns)}"
        raise BadFile(path, "table", found_words, "a column T_<sensor>_degC or spindle_rpm")
    return SensorRecord(
        path=Path(path),
        clock=clock,
        temperature=found,
        spindle_rpm=speed,
        remarks=tuple(f"{path}: {r}" for r in remarks),
    )


def _seconds(moment: datetime) -> float:
    return (moment - EPOCH).total_seconds()


def _words(clock: float) -> str:
    return (EPOCH + timedelta(seconds=float(clock))).strftime("%Y-%m-%d %H:%M")
