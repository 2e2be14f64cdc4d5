"""Makes the pages of the Python interface from the faces of `matstd` and its rooms, and docstrings.

    python docs/make_api.py        docs/api.md, the index, and HTML of everything in out/api

`make api` installs what it needs (pdoc) and runs it.
"""

import importlib
import inspect
from pathlib import Path
from pkgutil import iter_modules

import pdoc

import matstd

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

`import matstd` has all that the command line can do. Lengths are in mm, angles in rad, times in s,
temperatures in °C; `UM`, `URAD`, `DEG` and `MINUTE` are the units of files and figures. The files
are those of the commands ([formats](formats)). `make api` writes this page, and to `out/api` the
same with arguments and errors of every name.

    import matstd

    matstd.Project.read("project.toml").design("out")  # standard, CAD, programs, report

    found = matstd.diagnose(["monday.csv", "friday.csv"], auto=True)   # a run, a path, or several
    print(found)                                  # the verdict; in a notebook also its table
    found.save("diagnosis")                       # model.toml, diagnosis.json, report.html
    state = matstd.State(temperature={"spindle": 24.0})
    machine = found.compensate(tool_length=160.0, state=state)
    machine.tables("tables", ["sinumerik"])       # written, read back, played on the exact twin
    machine.program("part.H", "part-compensated.H")

[examples](../examples/README.md) 12 and 13 are such scripts.

### matstd

| name | is |
| --- | --- |
"""

ROOMS_HEAD = """\
## Rooms

Behind these names stand the rooms of the library. Every room is a package with parts; a part is
used through the names that its `__init__` lists. [architecture.md](architecture.md) describes how
the rooms depend on each other, [conventions.md](conventions.md) their frames, signs and units.
"""


def signature(name: str, thing: object) -> str:
    """A name with its arguments and their usual values, without types."""
    if not inspect.isroutine(thing):
        return name
    out = []
    for parameter in inspect.signature(thing).parameters.values():
        if parameter.name == "self":
            continue
        if parameter.kind is parameter.KEYWORD_ONLY and "*" not in out:
            out.append("*")
        value = parameter.default
        usual = value.__name__ if inspect.isroutine(value) else repr(value)
        stars = {parameter.VAR_KEYWORD: "**", parameter.VAR_POSITIONAL: "*"}.get(parameter.kind, "")
        is_open = value is parameter.empty
        out.append(stars + parameter.name + ("" if is_open else f"={usual}"))
    return f"{name}({', '.join(out)})"


def door_lines() -> list[str]:
    """The names of `matstd`: functions, results with their methods, and the rest."""
    things = {name: getattr(matstd, name) for name in matstd.__all__}
    functions = {n: t for n, t in things.items() if inspect.isroutine(t)}
    lines, long = [], []
    for name, thing in {**functions, **things}.items():
        place = importlib.import_module(f"matstd.{matstd._MODULES[name]}")
        described = pdoc.doc.Module(place).get(name)
        text = described.docstring if described else ""
        lines.append(f"| `{signature(name, thing)}` | {first_line(text)} |")
        if getattr(thing, "__module__", "").startswith("matstd.api"):
            for method in methods(thing):
                function = getattr(thing, method)  # a class method without its class
                if callable(function) and not method.startswith("_"):
                    said = first_line(inspect.getdoc(function) or "")
                    lines.append(f"| `{signature(f'{name}.{method}', function)}` | {said} |")
            body = inspect.cleandoc(text).replace("\n", "\n    ")
            long += [f"#### {name}", "", f"    {body}".replace("    \n", "\n"), ""]
    return [*lines, "", *long]


def methods(thing: object) -> list[str]:
    """Names in a class of the door and in the classes of the door that it extends, these first."""
    classes = reversed(thing.__mro__) if inspect.isclass(thing) else ()
    ours = [c for c in classes if c.__module__.startswith("matstd.api")]
    return list(dict.fromkeys(name for c in ours for name in vars(c)))


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
        texts = (found.docstring for m in places if (found := m.get(listed)) and found.docstring)
        lines.append(f"| `{listed}` | {first_line(next(texts, ''))} |")
    return [*lines, ""]


def index() -> str:
    """Rooms, parts and names, from bottom to top."""
    lines = [HEAD.rstrip("\n"), *door_lines(), ROOMS_HEAD]
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
    pdoc.pdoc("matstd", *ROOMS, output_directory=PAGES)
    print(f"{INDEX.relative_to(ROOT)} and {PAGES.relative_to(ROOT)}/index.html")


if __name__ == "__main__":
    main()
