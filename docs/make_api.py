"""Makes the pages of the Python interface from the faces of `matstd` and its rooms, and docstrings.

    python docs/make_api.py        docs/api.md, the index, and HTML of everything in out/api

`make api` installs what it needs (pdoc) and runs it.
"""

import ast
import importlib
import inspect
import io
import re
import textwrap
import tokenize
from dataclasses import replace
from pathlib import Path
from pkgutil import iter_modules
from types import ModuleType

import pdoc
from faces import face_of

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

`import matstd` has what the commands do with a machine, a run or a model. Tables of instruments are
read by `matstd.importers`: `read_sheet`, then for a positioning test `read_positioning` and
`positioning_run`. `new`, `examples` and `control-test` are of the command line alone. Lengths are
in mm, angles in rad, times in s, temperatures in °C; `UM`, `URAD`, `DEG` and `MINUTE` are the units
of files and figures. The files are those of the commands ([formats](formats)). `make api` writes
this page, and to `out/api` the same with arguments and errors of every name.

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
used through the names of its face, its `__init__`. [architecture.md](architecture.md) describes how
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
    given = inspect.signature(thing).return_annotation
    returned = "" if given in (None, "None", inspect.Signature.empty) else f" -> {typed(given)}"
    return f"{name}({', '.join(out)}){returned}"


def typed(annotation: object) -> str:
    """A type without the modules that define it."""
    text = annotation if isinstance(annotation, str) else inspect.formatannotation(annotation)
    text = re.sub(r"(?<![\w.])(?:\w+\.)+(?=\w)", "", text.strip("\"'"))
    return re.sub(r"ndarray\[.*?, dtype\[(\w+)\]\]", r"Array of \1", text).replace("|", "or")


def field_comments(thing: type | ModuleType) -> dict[str, str]:
    """What comments say of fields or constants: behind them, or in the lines above a field."""
    source = textwrap.dedent(inspect.getsource(thing))
    behind, above = {}, {}
    for token in tokenize.generate_tokens(io.StringIO(source).readline):
        if token.type == tokenize.COMMENT:
            text = token.string.removeprefix("#").strip()
            (above if token.line.lstrip().startswith("#") else behind)[token.start[0]] = text
    out = {}
    tree = ast.parse(source)
    for node in tree.body[0].body if inspect.isclass(thing) else tree.body:
        if isinstance(node, ast.AnnAssign | ast.Assign):
            first = node.lineno
            while first - 1 in above:
                first -= 1
            lines = [above[i] for i in range(first, node.lineno)] or [behind.get(node.end_lineno)]
            if lines != [None] and not lines[0].startswith(("noqa", "type:", "fmt:")):
                targets = node.targets if isinstance(node, ast.Assign) else [node.target]
                names = [n.id for t in targets for n in ast.walk(t) if isinstance(n, ast.Name)]
                out |= dict.fromkeys(names, " ".join(lines))
    return out


def attribute_lines(thing: object) -> list[str]:
    """Fields and properties of a class of ours and of those that it extends, these first."""
    said: dict[str, str] = {}
    types: dict[str, str] = {}
    classes = [c for c in thing.__mro__ if c.__module__.startswith("matstd.")]
    for own in reversed(classes):
        section = re.search(
            r"Attributes:\n((?:    .*\n|\n)*)", inspect.cleandoc(own.__doc__ or "") + "\n"
        )
        for name, text in re.findall(
            r"^    (\w+): (.*(?:\n {8}.*)*)", section[1] if section else "", re.M
        ):
            said[name] = text
        said |= field_comments(own)
        for name, annotation in inspect.get_annotations(own).items():
            types[name] = typed(annotation)
        for name, value in vars(own).items():
            function = getattr(value, "fget", None) or getattr(value, "func", None)
            if inspect.isfunction(function):
                types[name] = typed(inspect.get_annotations(function).get("return", ""))
                said[name] = first_line(inspect.getdoc(function) or said.get(name, ""))
    lines = [
        f"| `.{name}` | `{given}` | {first_line(said.get(name, ''))} |"
        for name, given in types.items()
        if not name.startswith("_") and "ClassVar" not in given
    ]
    return ["| attribute | type | is |", "| --- | --- | --- |", *lines, ""] if lines else []


def door_lines() -> list[str]:
    """The names of `matstd`: functions, results with their methods, and the rest."""
    things = {name: getattr(matstd, name) for name in matstd.__all__}
    functions = {n: t for n, t in things.items() if inspect.isroutine(t)}
    lines, long = [], []
    for name, thing in {**functions, **things}.items():
        place = importlib.import_module(matstd._MODULES[name])
        described = pdoc.doc.Module(place).get(name)
        text = described.docstring if described else ""
        lines.append(f"| `{signature(name, thing)}` | {first_line(text)} |")
        if getattr(thing, "__module__", "").startswith("matstd.api"):
            for method in methods(thing):
                function = getattr(thing, method)  # a class method without its class
                if callable(function) and not method.startswith("_"):
                    said = first_line(inspect.getdoc(function) or "")
                    lines.append(f"| `{signature(f'{name}.{method}', function)}` | {said} |")
        if inspect.isroutine(thing) or inspect.isclass(thing):
            plain = re.sub(r"\nAttributes:\n(    .*\n|\n)*", "\n", inspect.cleandoc(text) + "\n")
            body = plain.rstrip().replace("\n", "\n    ")
            long += [f"#### {name}", "", f"    {body}".replace("    \n", "\n"), ""]
        if inspect.isclass(thing):
            long += attribute_lines(thing)
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
        value = getattr(face.obj, listed)
        usual = f"`{value!r}`" if isinstance(value, str | int | float) else ""
        lines.append(f"| `{listed}` | {first_line(next(texts, usual))} |")
    return [*lines, ""]


def index() -> str:
    """Rooms, parts and names, from bottom to top."""
    rooms = [importlib.import_module(room) for room in ROOMS]
    faces = {f"{m.__name__}.{part}" for m in rooms for part in m.PARTS}
    for face in map(importlib.import_module, faces):
        face.__all__ = face_of(face)  # pdoc passes over what is imported and in no list
    lines = [HEAD.rstrip("\n"), *door_lines(), ROOMS_HEAD]
    for module in rooms:
        lines += [f"## {module.__name__}", "", first_line(module.__doc__ or ""), ""]
        for part in module.PARTS:
            lines += part_lines(f"{module.__name__}.{part}")
    return "\n".join(lines)


def read_comments() -> None:
    """Make pdoc take what comments say of fields and constants for their docstrings."""
    walked = pdoc.doc_ast.walk_tree

    def with_comments(thing: object) -> pdoc.doc_ast.AstInfo:
        info = walked(thing)
        place = getattr(thing, "__module__", getattr(thing, "__name__", ""))
        is_ours = not inspect.isroutine(thing) and place.startswith("matstd.")
        comments = field_comments(thing) if is_ours else {}
        return replace(info, var_docstrings={**comments, **info.var_docstrings})

    pdoc.doc_ast.walk_tree = with_comments


def main() -> None:
    """Write index and pages."""
    read_comments()
    INDEX.write_text(index(), encoding="utf-8")
    pdoc.render.configure(docformat="google")
    pdoc.pdoc("matstd", *ROOMS, output_directory=PAGES)
    print(f"{INDEX.relative_to(ROOT)} and {PAGES.relative_to(ROOT)}/index.html")


if __name__ == "__main__":
    main()
