"""Makes the pages of the Python interface from the faces of the rooms and their docstrings.

    python docs/make_api.py        docs/api.md, the index, and HTML of everything in out/api

`make api` installs what it needs (pdoc) and runs it.
"""

import importlib
from pathlib import Path
from pkgutil import iter_modules

import pdoc

ROOT = Path(__file__).parents[1]
INDEX, PAGES = ROOT / "docs" / "api.md", ROOT / "out" / "api"
ROOMS = (
    "matstd.twin",
    "matstd.importers",
    "matstd.sensitivity",
    "matstd.information",
    "matstd.nc",
    "matstd.artefact",
    "matstd.diagnosis",
    "matstd.cad_out",
    "matstd.probe_paths",
    "matstd.compensation",
    "matstd.report",
)
"""From bottom to top."""

HEAD = """\
# Python interface

Every room is a package with parts; a part is used through the names that its `__init__` lists.
[architecture.md](architecture.md) says how the rooms hang together,
[conventions.md](conventions.md) which frames, signs and units they share. `make api` writes this
page, and to `out/api` the same with signatures, arguments, units and errors of every name.
"""


def first_line(docstring: str) -> str:
    """The first paragraph of a docstring, as a cell of a table."""
    return " ".join(docstring.partition("\n\n")[0].split()).replace("|", "\\|")


def part_lines(name: str) -> list[str]:
    """A part and the names of its face, with one line each."""
    face = pdoc.doc.Module(importlib.import_module(name))
    lines = [f"### {name}", "", first_line(face.docstring), "", "| name | is |", "| --- | --- |"]
    # what is documented below a constant stands only in the module that defines it
    inside = (importlib.import_module(f"{name}.{m.name}") for m in iter_modules(face.obj.__path__))
    places = [face, *map(pdoc.doc.Module, inside)]
    for listed in face.obj.__all__:
        told = (found.docstring for m in places if (found := m.get(listed)) and found.docstring)
        lines.append(f"| `{listed}` | {first_line(next(told, ''))} |")
    return [*lines, ""]


def index() -> str:
    """Rooms, parts and names, from bottom to top."""
    lines = [HEAD]
    for room in ROOMS:
        module = importlib.import_module(room)
        lines += [f"## {room}", "", first_line(module.__doc__ or ""), ""]
        for part in module.PARTS:
            lines += part_lines(f"{room}.{part}")
    return "\n".join(lines)


def main() -> None:
    """Write index and pages."""
    INDEX.write_text(index(), encoding="utf-8")
    pdoc.render.configure(docformat="google")
    pdoc.pdoc(*ROOMS, output_directory=PAGES)
    print(f"{INDEX.relative_to(ROOT)} and {PAGES.relative_to(ROOT)}/index.html")


if __name__ == "__main__":
    main()
