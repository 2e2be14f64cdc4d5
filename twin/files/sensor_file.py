"""Readings of temperature sensors by the clock, and what they were at every touch."""

from dataclasses import dataclass, replace
from datetime import datetime, timedelta
from pathlib import Path

import numpy as np

from twin.errors import BadFile
from twin.files.run_columns import temperatures
from twin.files.table import CsvTable
from twin.files.toml import read_text
from twin.frames import Array
from twin.record import Run

EPOCH = datetime(2000, 1, 1)

BEYOND = 300.0
"""Longest time that a touch may lie outside the record, s; its first or last reading then holds."""


@dataclass(frozen=True, eq=False)
class SensorRecord:
    """Readings of sensors.

    Attributes:
        path: Where they came from.
        clock: Of every reading, s since `EPOCH`, (M,), rising.
        temperature: By sensor, each (M,), degC.
        remarks: On sensors that were left out, or are constant.
    """

    path: Path
    clock: Array
    temperature: dict[str, Array]
    remarks: tuple[str, ...]

    def joined(self, run: Run, begin: datetime) -> Run:
        """A run with the temperatures at its touches, linear in time between readings.

        Args:
            run: The measurements.
            begin: What the clock said at the run's time zero.

        Raises:
            BadFile: The record does not cover the run.
        """
        at = _seconds(begin) + run.touches.time
        first, last = self.clock[0], self.clock[-1]
        if at.min() < first - BEYOND or at.max() > last + BEYOND:
            raise BadFile(
                self.path, "column clock",
                f"readings from {_words(first)} to {_words(last)}",
                f"readings over the run, {_words(at.min())} to {_words(at.max())}",
            )  # fmt: skip
        values = {s: np.interp(at, self.clock, v) for s, v in self.temperature.items()}
        touches = replace(run.touches, temperature={**run.touches.temperature, **values})
        return replace(run, touches=touches, remarks=(*run.remarks, *self.remarks))


def read_sensors(path: str | Path) -> SensorRecord:
    """Read a table with a column `clock` (2031-05-06T07:08:09) and `T_<sensor>_degC` columns.

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
        if i and clock[i] <= clock[i - 1]:
            raise table.bad(i, "clock", cell, "a later reading in every row")
    remarks: list[str] = []
    found = temperatures(table, remarks)
    if not found:
        found_words = "; ".join(remarks) or f"columns {', '.join(table.columns)}"
        raise BadFile(path, "table", found_words, "a column T_<sensor>_degC")
    return SensorRecord(Path(path), clock, found, tuple(f"{path}: {r}" for r in remarks))


def _seconds(moment: datetime) -> float:
    return (moment - EPOCH).total_seconds()


def _words(clock: float) -> str:
    return (EPOCH + timedelta(seconds=float(clock))).strftime("%Y-%m-%d %H:%M")
