"""Tables of the keys of users' files in docs/formats, written from the models of their readers.

    python docs/make_formats.py

Kind, range and default of a key stand in its model, the description in the docstring below it.
"""

import importlib
import re
from enum import Enum
from pathlib import Path

from matstd.twin.files import Table
from matstd.twin.text import toml_value

FOLDER = Path(__file__).parent / "formats"

MODULES = (
    "matstd.twin.files.machine_file",
    "matstd.twin.files.error_file",
    "matstd.twin.files.run_file",
    "matstd.artefact.brief.project_file",
    "matstd.artefact.brief.standard_tables",
    "matstd.artefact.brief.standard_tables",
    "matstd.artefact.brief.workshop_tables",
    "matstd.artefact.brief.errors_table",
    "matstd.artefact.brief.task_file",
)
"""Readers of the files that users write; the tables of other files are written by hand."""

_TABLE = re.compile(r"(<!-- describes (\S+)\.(\w+) -->\n)\| key .*\n\| --- .*\n(?:\|.*\n)+")


def default_of(model: type[Table], key: str) -> str:
    """The default of a key as its table shows it."""
    fields = {field.alias or name: field for name, field in model.model_fields.items()}
    field = fields[key]
    default = field.get_default(call_default_factory=True, validated_data={})
    if field.is_required():
        return "needed"
    if default is None or default in ({}, [], (), float("inf")):
        return "none"
    if isinstance(default, Table):
        return "its defaults"
    if isinstance(default, dict):
        return "one, `[setup.a]`"
    return f"`{toml_value(default.value if isinstance(default, Enum) else default)}`"


def rows(model: type[Table]) -> str:
    """One row per key: its name, its default, what it is and its range."""
    out = ""
    for name, key in model.keys().items():
        cells = [f"`{name}`", default_of(model, name), key.range, key.about]
        out += f"| {' | '.join(cells)} |\n"
    return out


def written(page: str) -> str:
    """A page with its tables made anew."""

    def table(match: re.Match[str]) -> str:
        head, module, name = match.groups()
        if module not in MODULES:
            return match.group()
        title = "| key | default | range | meaning |\n| --- | --- | --- | --- |\n"
        return head + title + rows(getattr(importlib.import_module(module), name))

    return _TABLE.sub(table, page)


if __name__ == "__main__":
    for path in sorted(FOLDER.glob("*.md")):
        text = path.read_text(encoding="utf-8")
        path.write_text(written(text), encoding="utf-8", newline="\n")
