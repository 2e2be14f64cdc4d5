"""Mapping file (TOML, "import/1"): which column of a foreign table is which column of a run."""

import csv
import io
from pathlib import Path
from typing import Any

import numpy as np
from pydantic import Field

from twin.errors import BadFile
from twin.files import Table, check_format, checked, parse_toml, read_text
from twin.foreign.sheet import Sheet


class ColumnTable(Table):
    """`X_mm = { from = "x pos", factor = 2.5, offset = 0.0, missing = -180.0 }`."""

    source: str = Field(alias="from")
    factor: float = 1.0
    offset: float = 0.0
    missing: float | None = None


class MappingTable(Table):
    """The whole file: `[head]` as in a run file, `[columns]` how each is made."""

    format: str
    head: dict[str, Any]
    columns: dict[str, ColumnTable | float | int | str]


_TEXT = ("feature", "setup", "pose", "split")
"""Columns of a run that hold names."""


def mapped_run(sheet: Sheet, path: str | Path) -> str:
    """Text of a run file from a foreign table and a mapping file.

    A column is `factor * cell + offset` of a foreign one, or a constant (a number, or a name for
    `feature`, `setup`, `split`). The head stands in the mapping file as it shall stand in the run.

    Args:
        path: The mapping file.

    Raises:
        BadFile: The mapping file's key, or a column that the table does not have.
    """
    data = parse_toml(read_text(path), path)
    check_format(data, "import/1", path)
    table = checked(MappingTable, data, path)
    if not any(isinstance(how, ColumnTable) for how in table.columns.values()):
        found = "constants alone" if table.columns else "nothing"
        raise BadFile(path, "columns", found, 'a column such as { from = "x" }')
    cells = {name: _cells(sheet, name, how, path) for name, how in table.columns.items()}
    out = io.StringIO()
    import tomli_w

    head = {"format": "run/1", **table.head}
    out.writelines(f"# {line}".rstrip() + "\n" for line in tomli_w.dumps(head).splitlines())
    writer = csv.writer(out, lineterminator="\n")
    writer.writerow(cells)
    writer.writerows(zip(*cells.values(), strict=True))
    return out.getvalue()


def _cells(sheet: Sheet, name: str, how: ColumnTable | float | str, path: str | Path) -> list[str]:
    """Cells of one column of the run."""
    if not isinstance(how, ColumnTable):
        return [str(how)] * len(sheet)
    if how.source not in sheet.columns:
        found = f"{how.source!r}, and {sheet.path} has no such column"
        raise BadFile(path, f"columns.{name}", found, f"one of {', '.join(sheet.columns)}")
    column = sheet.columns.index(how.source)
    if name in _TEXT:
        return sheet.text(column)
    values = how.factor * sheet.numbers(column, how.missing) + how.offset
    # repr: the shortest text that gives the same number back
    return ["" if np.isnan(v) else repr(float(v)) for v in values]
