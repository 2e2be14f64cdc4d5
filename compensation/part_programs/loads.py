"""Process forces by the blocks of a program: a table of lines and loads."""

from pathlib import Path
from typing import NamedTuple

import numpy as np

from matstd.twin.errors import BadFile
from matstd.twin.files import CsvTable, read_text
from matstd.twin.frames import Array

COLUMNS = ("first_line", "last_line", "Fx_N", "Fy_N", "Fz_N")
MAX_FORCE = 1e5  # largest plausible cutting force, N


class Load(NamedTuple):
    """Force on the tool in table-frame directions while some lines of a program run, N."""

    first: int
    last: int
    force: tuple[float, float, float]


def read_loads(path: str | Path) -> tuple[Load, ...]:
    """Loads of a table with the columns first_line, last_line, Fx_N, Fy_N, Fz_N.

    Raises:
        BadFile: A column that is missing or unknown, lines in no order or named twice.
    """
    table = CsvTable(read_text(path), path)
    table.require(COLUMNS)
    table.allow_only(COLUMNS)
    first, last = (table.numbers(c, smallest=1.0) for c in COLUMNS[:2])
    force = np.column_stack([table.numbers(c, largest=MAX_FORCE) for c in COLUMNS[2:]])
    out: list[Load] = []
    for row, (a, b) in enumerate(zip(first.astype(int), last.astype(int), strict=True)):
        if b < a:
            raise table.bad(row, "last_line", b, f"{a} or more")
        if any(load.first <= b and a <= load.last for load in out):
            raise table.bad(row, "first_line", a, "lines that no other row names")
        x, y, z = force[row].tolist()
        out.append(Load(int(a), int(b), (x, y, z)))
    if not out:
        raise BadFile(path, "table", "no rows", "a row for every load")
    return tuple(out)


def forces(lines: list[int], loads: tuple[Load, ...], usual: Array) -> Array:
    """Force while each motion runs, (M, 3), N.

    Args:
        usual: Where no load names the line, (3,).
    """
    out = np.tile(usual, (len(lines), 1))
    number = np.array(lines)
    for load in loads:
        out[(number >= load.first) & (number <= load.last)] = load.force
    return out
