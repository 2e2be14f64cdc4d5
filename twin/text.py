"""Text of the files that programs read: JSON and CSV, each in one way."""

import csv
import io
import json
import math
from collections.abc import Iterable, Mapping
from datetime import date
from enum import Enum
from typing import Any


def json_text(table: Mapping[str, Any], sort_keys: bool = False) -> str:
    r"""A table as JSON; a number that is not finite is null, since JSON has none.

    Example:
        >>> json_text({"format": "x/1", "u_µm": [0.5, float("nan")]})
        '{\n "format": "x/1",\n "u_µm": [\n  0.5,\n  null\n ]\n}\n'
    """
    finite = _finite(table)
    text = json.dumps(finite, indent=1, ensure_ascii=False, allow_nan=False, sort_keys=sort_keys)
    return text + "\n"


def _finite(value: Any) -> Any:
    if isinstance(value, Mapping):
        return {key: _finite(inner) for key, inner in value.items()}
    if isinstance(value, list | tuple):
        return [_finite(inner) for inner in value]
    return None if isinstance(value, float) and not math.isfinite(value) else value


def csv_text(names: Iterable[str], rows: Iterable[Iterable[object]]) -> str:
    r"""A line of names and a line a row, cells parted by commas and quoted where they need it.

    Example:
        >>> csv_text(["X_mm", "setup"], [[0.5, "a"], ["1.00", "b, c"]])
        'X_mm,setup\n0.5,a\n1.00,"b, c"\n'
    """
    out = io.StringIO()
    writer = csv.writer(out, lineterminator="\n")
    writer.writerow(names)
    writer.writerows(rows)
    return out.getvalue()


def toml_value(value: object) -> str:
    """A value as it stands in a TOML file.

    Example:
        >>> toml_value((280.0, 280.0)), toml_value(True), toml_value("I")
        ('[280.0, 280.0]', 'true', '"I"')
    """
    if isinstance(value, bool):
        return str(value).lower()
    if isinstance(value, Enum):
        return toml_value(value.value)
    if isinstance(value, str):
        return '"' + value.replace("\\", "\\\\").replace('"', '\\"') + '"'
    if isinstance(value, date):
        return value.isoformat()
    if isinstance(value, list | tuple):
        return f"[{', '.join(map(toml_value, value))}]"
    return repr(value)
