"""Mapping file (TOML, "import/1"): the columns of a run by those of a foreign table."""

import io
import tempfile
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any, Literal, NamedTuple

import numpy as np
from pydantic import Field

from matstd.importers.sheets import ANGLES, Sheet, clock_times, has_clock, unit_of_column
from matstd.twin.errors import BadFile
from matstd.twin.files import Table, checked, read_machine, read_run, read_toml, write_whole
from matstd.twin.frames import Array
from matstd.twin.machine import Chain
from matstd.twin.record import Run
from matstd.twin.text import csv_text


class ColumnTable(Table):
    """`X_mm = { from = "angle", of = "cos", factor = 150.0, offset = 0.0, missing = -180.0 }`."""

    source: str = Field(alias="from")
    of: Literal["cos", "sin", "sign"] | None = None
    factor: float = 1.0
    offset: float = 0.0
    missing: float | None = None


How = ColumnTable | float | int | str  # source of a column: one of the table, or a constant


class MappingTable(Table):
    """The whole file: `[head]` as in a run file, `[columns]` and `[[rows]]` how each is made."""

    format: str
    head: dict[str, Any]
    columns: dict[str, How] = Field(default_factory=dict)
    rows: list[dict[str, How]] = Field(default_factory=list)


_TEXT = ("feature", "setup", "pose", "split")  # columns of a run that hold names


class MappedRun(NamedTuple):
    """Text of a run file, the run read from it, and the number of readings without a deviation."""

    text: str
    run: Run
    left_out: int


def import_mapped(
    sheet: Sheet, path: str | Path, folder: Path, chain: Chain | None = None
) -> MappedRun:
    """A run by a mapping file, checked by reading it as the run file that it makes; raises BadFile.

    Args:
        folder: Folder of the run file; its head names the machine relative to it.
        chain: The machine, in place of the one that the head names.
    """
    text, left_out = mapped_run(sheet, path)
    if chain is None:
        named = read_toml(path, "import/1")["head"].get("machine")
        if not isinstance(named, str):
            raise BadFile(path, "head.machine", "nothing", "the machine file, or --machine")
        chain = read_machine(folder / named)
    with tempfile.TemporaryDirectory() as trial:
        file = Path(trial) / "run.csv"
        write_whole(file, text)
        try:
            return MappedRun(text, read_run(file, chain), left_out)
        except BadFile as error:
            where = f"what it makes of {sheet.path}: {error.facts['where']}"
            expected = str(error.facts["expected"])
            raise BadFile(path, where, error.facts["found"], expected) from error


def mapped_run(sheet: Sheet, path: str | Path) -> tuple[str, int]:
    """Text of a run file from a foreign table and a mapping file; raises BadFile.

    A column is `factor * cell + offset` of a foreign one, or a constant (a number, or a name for
    `feature`, `setup`, `split`); with `of` the cosine, sine or sign of the cell stands for it.
    Where a row of the table holds several readings at one instant, each `[[rows]]` makes one row of
    the run from it, of one pose, with its own and the common columns. The head of the run is
    copied.

    Returns:
        The text, and the number of readings left out because they have no deviation.
    """
    import tomli_w

    table = checked(MappingTable, read_toml(path, "import/1"), path)
    blocks = _blocks(table, path)
    each = [
        {name: _cells(sheet, name, how, f"{key}.{name}", path) for name, (how, key) in b.items()}
        for b in blocks
    ]
    if table.rows and "pose" not in each[0]:
        each = [{**b, "pose": [str(i) for i in range(len(sheet))]} for b in each]
    lines = [line for row in zip(*(zip(*b.values(), strict=True) for b in each), strict=True)
             for line in row]  # fmt: skip
    names = list(each[0])
    kept = lines
    if "dev_um" in names:
        kept = [line for line in lines if line[names.index("dev_um")]]
    out = io.StringIO()
    head = {"format": "run/1", **table.head}
    out.writelines(f"# {line}".rstrip() + "\n" for line in tomli_w.dumps(head).splitlines())
    return out.getvalue() + csv_text(names, kept), len(lines) - len(kept)


def _blocks(table: MappingTable, path: str | Path) -> Sequence[Mapping[str, tuple[How, str]]]:
    """Columns of every reading of a row of the table, with the key of the file they stand in."""
    common: dict[str, tuple[How, str]] = {n: (h, "columns") for n, h in table.columns.items()}
    blocks = [
        {**common, **{name: (how, f"rows[{i}]") for name, how in own.items()}}
        for i, own in enumerate(table.rows)
    ] or [common]
    for i, block in enumerate(blocks):
        if odd := set(block) ^ set(blocks[0]):
            found = f"{min(odd)!r} in some of them only"
            raise BadFile(path, f"rows[{i}]", found, "the same columns in every one")
    if not any(isinstance(how, ColumnTable) for block in blocks for how, _ in block.values()):
        found = "constants alone" if blocks[0] else "nothing"
        raise BadFile(path, "columns", found, 'a column such as { from = "x" }')
    return [{name: block[name] for name in blocks[0]} for block in blocks]


def _cells(sheet: Sheet, name: str, how: How, key: str, path: str | Path) -> list[str]:
    """Cells of one column of the run."""
    if not isinstance(how, ColumnTable):
        return [str(how)] * len(sheet)
    if how.source not in sheet.columns:
        found = f"{how.source!r}, and {sheet.path} has no such column"
        raise BadFile(path, key, found, f"one of {', '.join(sheet.columns)}")
    column = sheet.column(how.source)
    if name in _TEXT:
        return sheet.text(column)
    values = how.factor * _values(sheet, column, name, how) + how.offset
    # twelve digits: more would show rounding, as in 0.1 * 3
    return ["" if np.isnan(v) else f"{v + 0.0:.12g}" for v in values]


def _values(sheet: Sheet, column: int, name: str, how: ColumnTable) -> Array:
    """Numbers of a column of the table, or what is wanted of them, (N,)."""
    if name == "time_s" and how.of is None and how.missing is None:
        return clock_times(sheet, column) if has_clock(sheet, column) else sheet.numbers(column)
    values = sheet.numbers(column, how.missing)
    if how.of is None:
        return values
    if how.of == "sign":
        return np.sign(values)
    angle = values * ANGLES.get(unit_of_column(sheet.columns[column]) or "deg", 1.0)
    return np.cos(angle) if how.of == "cos" else np.sin(angle)
