"""Text of a new project file: chosen keys with the descriptions that refusals and pages have."""

from collections.abc import Mapping
from typing import get_args

from matstd.artefact.brief.project_file import ProjectTable
from matstd.artefact.brief.workshop_tables import TableTable
from matstd.twin.files import SetupTable, Table
from matstd.twin.text import toml_value

COMMENT = 46  # column at which comments begin

_OTHERS: dict[str, type[Table]] = {"setup.a": SetupTable, "workshop.table": TableTable}
"""Tables within tables."""


def project_text(tables: Mapping[str, Mapping[str, object]]) -> str:
    """A commented project file.

    Args:
        tables: Values by key, by table; "" are the keys of no table. `[workspace]` takes any axis.
    """
    out = ""
    for name, values in tables.items():
        out += f"\n[{name}]\n" if name else ""
        known = _model(name).keys() if name != "workspace" else {}
        for key, value in values.items():
            unit = "degrees" if key[0] in "ABC" else "mm"
            what = f"readings of interest, {unit}" if name == "workspace" else known[key].short
            if key == "format":
                what = "kind and version of the file"
            out += f"{f'{key} = {toml_value(value)}':<{COMMENT}} # {what}\n"
    return out


def _model(name: str) -> type[Table]:
    """The model of a table of a project."""
    if not name or name in _OTHERS:
        return _OTHERS.get(name, ProjectTable)
    kind = ProjectTable.model_fields[name].annotation
    found = next((k for k in (kind, *get_args(kind)) if isinstance(k, type)), None)
    assert found is not None
    assert issubclass(found, Table)
    return found
