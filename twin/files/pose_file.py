"""Pose file (CSV): axis readings, one row per pose, `X_mm,...,B_deg,...[,tool_length_mm]`."""

from collections.abc import Iterator
from pathlib import Path
from typing import NamedTuple

import numpy as np

from matstd.twin.errors import BadFile
from matstd.twin.files.table import CsvTable
from matstd.twin.files.toml import read_text
from matstd.twin.frames import Array, IntArray
from matstd.twin.machine import Chain
from matstd.twin.units import USUAL_TOOL_LENGTH, in_another_unit

FARTHEST = 1e5
"""A length (mm) or an angle (degrees) beyond this is a slip, not a reading or a place."""
READING_ROUNDING = 1e-6  # share of the travel by which the rounding of a reading may exceed it


def reading_columns(chain: Chain) -> dict[str, tuple[str, float]]:
    """Column name and factor to base units of every axis: `X_mm`, `B_deg`."""
    return {name: (chain.link(name).column, chain.link(name).unit) for name in chain.axes}


def readings(table: CsvTable, chain: Chain) -> Array:
    """Readings (N, A), zero of a spindle that is left out; raises BadFile."""
    names = reading_columns(chain)
    table.require(names[axis][0] for axis in chain.programmed_axes)
    q = np.zeros((len(table), len(chain.axes)))
    for i, axis in enumerate(chain.axes):
        column, factor = names[axis]
        if column in table:
            q[:, i] = table.numbers(column, largest=FARTHEST) * factor
    return q


class BeyondTravel(NamedTuple):
    """Rows beyond the travel of one axis, with the column, the first reading and the rule."""

    rows: IntArray
    column: str
    found: str
    expected: str


def beyond_travel(chain: Chain, q: Array, slack: float) -> Iterator[BeyondTravel]:
    """Readings (N, A) beyond the travel of their axes by more than a share of it."""
    for i, (axis, (column, factor)) in enumerate(reading_columns(chain).items()):
        low, high = chain.link(axis).range
        margin = slack * (high - low)
        rows = np.flatnonzero((q[:, i] < low - margin) | (q[:, i] > high + margin))
        if len(rows):
            travel = f"{low / factor:g} to {high / factor:g}"
            expected = f"a reading within the travel {travel} of axis {axis}"
            yield BeyondTravel(rows, column, f"{q[rows[0], i] / factor:.6g}", expected)


def read_poses(path: str | Path, chain: Chain) -> tuple[Array, Array]:
    """Poses and tool lengths; raises BadFile.

    Returns:
        Readings (N, A), mm and rad, and tool lengths (N,), mm, zero where the file has none.
    """
    table = CsvTable(read_text(path), path)
    known = [column for column, _ in reading_columns(chain).values()] + ["tool_length_mm"]
    table.allow_only(known)
    if not len(table):
        raise BadFile(path, "table", "no rows", "one row per pose")
    q = readings(table, chain)
    for beyond in beyond_travel(chain, q, READING_ROUNDING):
        raise table.bad(int(beyond.rows[0]), beyond.column, beyond.found, beyond.expected)
    if "tool_length_mm" not in table:
        return q, np.zeros(len(table))
    lengths = table.numbers("tool_length_mm", largest=FARTHEST, smallest=0.0)
    slip = in_another_unit([float(lengths.max())], "mm", USUAL_TOOL_LENGTH)
    if slip is not None:
        row = int(lengths.argmax())
        raise table.bad(row, "tool_length_mm", f"{lengths[row]:g}", f"mm; is it in {slip[0]}?")
    return q, lengths
