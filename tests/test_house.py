"""The architecture as a test: floors, parts, faces, heavy imports, sizes, start-up."""

import ast
import importlib
import re
import runpy
import subprocess
import sys
import tomllib
from functools import cache
from pathlib import Path
from types import ModuleType

import pytest
from faces import face_of

ROOT = Path(__file__).parents[1]
BELOW = {
    "twin": set(),
    "importers": {"twin"},
    "sensitivity": {"twin"},
    "information": {"twin"},
    "nc": {"twin"},
    "artefact": {"twin", "importers", "sensitivity", "information"},
    "diagnosis": {"twin", "information"},
    "cad_out": {"twin", "artefact"},
    "probe_paths": {"twin", "artefact", "nc"},
    "compensation": {"twin", "diagnosis", "nc"},
}
ALLOWED = BELOW | {"report": set(BELOW), "matstd": {*BELOW, "report"}}
"""Which rooms a room may import."""
VOCABULARY = {
    "twin.units",
    "twin.numbers",
    "twin.rows",
    "twin.text",
    "twin.sampling",
    "twin.frames",
    "twin.errors",
    "twin.words",
    "twin.compute",
    "twin.beside",
    "twin.display",
    "twin.files.whole",
    "twin.versions",
    "report.numbers",
}
"""Modules that every room speaks: they lie below all parts and are imported as they are."""
HEAVY = {"build123d", "OCP", "pyvista", "vtk", "matplotlib", "trimesh", "manifold3d"}
DRAWING = {"matplotlib", "pyvista", "vtk"}
# The kernel's own files name forty of its classes each; they are imported inside functions only.
KERNEL = {
    f"cad_out/kernel/{name}.py"
    for name in (
        [
            "assembly",
            "exchange",
            "faces",
            "letters",
            "parts",
            "pmi",
            "primitives",
            "reader",
            "solid",
            "xcaf",
        ]
    )
}
MAX_FILES = 16
MAX_LINES = 400
MAX_CODE = 60
FACE = range(2, 27)
"""Names of a face."""
UNIT = re.compile(r"µm|µrad|°|\b(?:mm|min|degC)\b")
CARDS = {"formula", "units", "typical", "source", "summary"}
"""Fields of the card of a kind of effect (`Kind`): text that is data, shown as it is."""
EXCUSED = {
    "twin/files/run_columns.py": "remarks of a reader on single lines, like its refusals",
    "twin/files/run_checks.py": "kinds of unit mistakes, put into one line of refusal",
    "importers/files/machine_draft.py": "comments of a machine file that is written",
    "probe_paths/plan/planner.py": "reason of a refusal, as the reach has it",
    "probe_paths/control/clock.py": "remarks of a reader on single lines, like its refusals",
    "probe_paths/campaign/as_programmed.py": "refusals that name what stood in a log",
    "probe_paths/campaign/log_parts.py": "remarks of a reader on a log, like its refusals",
    "probe_paths/campaign/contact_points.py": "remark of the same reader on a feature out of place",
    "twin/library/trial.py": "the unit that a refusal of a user's effect expects",
    "twin/units.py": "question about the length of a tool, put into several refusals",
    "twin/files/slips.py": "slips of units in a file, put into one refusal",
    "artefact/compare/alternatives.py": "names of other set-ups, shown as they are",
    "artefact/feasibility/standing.py": "what is wrong with a body, put into one refusal",
    "artefact/brief/contradictions.py": "refusals that are collected before they are raised",
    "artefact/feasibility/within_travels.py": "what binds, put into one refusal",
    "artefact/reach/touchable.py": "reason that a refusal counts",
    "cad_out/details/tolerances.py": "general notes of the drawing and the STEP file",
    "artefact/certify/cmm_points_file.py": "remarks of a reader on single lines, like its refusals",
    "artefact/hidden/scan_path.py": "comment in the head of a file that is written",
    "artefact/certify/dmis.py": "comments in a program that is written",
    "cad_out/verify/conformity.py": "list of what is out of its limit, for one refusal",
    "diagnosis/drift/log_file.py": "remarks of a reader on a log, like its refusals",
    "compensation/tables/iso_csv.py": "comment in the head of a file that is written",
    "diagnosis/fit/unit_mistakes.py": "refusal, and the same where it is only suspected",
}
"""Files below `report` with units in prose outside a `raise` all the same, and why."""

FILES = [f for room in ALLOWED for f in sorted((ROOT / room).rglob("*.py"))]
IN_ROOM = {room: [f for f in FILES if f.is_relative_to(ROOT / room)] for room in ALLOWED}


def in_house(name: str) -> str:
    """The name of a module in this checkout: `matstd.twin.machine` stands in `twin.machine`."""
    inner = name.removeprefix("matstd.")
    return inner if inner.split(".")[0] in ALLOWED else name


def load(name: str) -> ModuleType:
    """The module with this name in the checkout, under the name that is installed."""
    return importlib.import_module(name if name.startswith("matstd") else f"matstd.{name}")


PARTS = {room: load(room).PARTS for room in ALLOWED if room != "matstd"}


@cache
def tree_of(file: Path) -> ast.Module:
    """Read where a test asks for it: every worker collects this file, one runs it."""
    return ast.parse(file.read_text(encoding="utf-8"))


@cache
def nodes_of(tree: ast.AST) -> list[ast.AST]:
    """All nodes of a tree; a dozen tests look at those of every file."""
    return list(ast.walk(tree))


def module_of(file: Path) -> str:
    """Dotted name of a file's module."""
    return ".".join(file.relative_to(ROOT).with_suffix("").parts).removesuffix(".__init__")


def imports(tree: ast.AST) -> list[tuple[str, int]]:
    """All imported modules with their line."""
    found = []
    for node in nodes_of(tree):
        if isinstance(node, ast.Import):
            found += [(in_house(alias.name), node.lineno) for alias in node.names]
        elif isinstance(node, ast.ImportFrom) and node.module and not node.level:
            found.append((in_house(node.module), node.lineno))
    return found


def top_level_imports(tree: ast.Module) -> list[tuple[str, int]]:
    """The same without those inside functions and `if TYPE_CHECKING:`."""
    body = [n for n in tree.body if isinstance(n, ast.Import | ast.ImportFrom)]
    return imports(ast.Module(body=body, type_ignores=[]))


def imports_by_string(tree: ast.AST) -> list[tuple[str, int]]:
    """Modules of ours that are named in a string, as `import_module("matstd.report")` does."""
    return [
        (in_house(text), node.lineno)
        for node in nodes_of(tree)
        if isinstance(node, ast.Constant | ast.JoinedStr)
        and re.match(r"matstd(\.\w+)+", text := text_of(node))
        and " " not in text
        and in_house(text) != text
        and not text.endswith((".toml", ".csv", ".json"))
    ]


def is_package(name: str) -> bool:
    """Whether a dotted name is a folder of ours."""
    return (ROOT / name.replace(".", "/") / "__init__.py").exists()


def part_of(name: str) -> str:
    """`twin.machine.chain` -> `twin.machine`; what lies beside the parts is its own."""
    return ".".join(name.split(".")[:2])


def test_rooms_have_one_name() -> None:
    """`import twin` would find a user's own twin.py, or run a module a second time."""
    files = subprocess.run(
        ["git", "ls-files", "*.py"], cwd=ROOT, capture_output=True, text=True, check=True
    ).stdout.split()
    rooms = "|".join(BELOW | {"report": set()})
    bare = re.compile(rf"^\s*(?:import|from)\s+(?:{rooms})\b.*", re.MULTILINE)
    for file in files:
        text = (ROOT / file).read_text(encoding="utf-8")
        # a line of a docstring or of a text is no import: only a file that has one is parsed
        tree = ast.parse(text if bare.search(text) else "")
        for node in ast.walk(tree):
            names = [a.name for a in node.names] if isinstance(node, ast.Import) else []
            if isinstance(node, ast.ImportFrom) and node.module and not node.level:
                names.append(node.module)
            for name in names:
                assert name.split(".")[0] not in BELOW | {"report": set()}, f"{file}: {name}"


@pytest.mark.parametrize("room", ALLOWED)
def test_rooms_import_one_way(room: str) -> None:
    for file in IN_ROOM[room]:
        for name, line in imports(tree_of(file)) + imports_by_string(tree_of(file)):
            other = name.split(".")[0]
            assert other not in ALLOWED or other == room or other in ALLOWED[room], (
                f"{file}:{line}: {room} imports {other}"
            )


@pytest.mark.parametrize("room", PARTS)
def test_parts_import_one_way(room: str) -> None:
    """Within a room a part imports only those that its `__init__` lists before it."""
    order = [f"{room}.{part}" for part in PARTS[room]]
    for file in IN_ROOM[room]:
        me = module_of(file)
        if me == room:
            continue
        mine = order.index(part_of(me)) if part_of(me) in order else -1
        assert mine >= 0 or part_of(me) in VOCABULARY, f"{me} is no part of {room}"
        for name, line in imports(tree_of(file)):
            if name.split(".")[0] != room or name in VOCABULARY:
                continue
            assert name != room, f"{file}:{line}: imports its own room"
            assert order.index(part_of(name)) <= mine, f"{file}:{line}: {name} is above"


@pytest.mark.parametrize("room", ALLOWED)
def test_parts_are_entered_by_their_faces(room: str) -> None:
    """Other parts and rooms import from an `__init__`, and only what it lists."""
    for file in IN_ROOM[room]:
        mine = part_of(module_of(file))
        for node in nodes_of(tree_of(file)):
            if not isinstance(node, ast.ImportFrom) or not node.module or node.level:
                continue
            name = in_house(node.module)
            if name.split(".")[0] not in PARTS or part_of(name) == mine or name in VOCABULARY:
                continue
            where = f"{file}:{node.lineno}"
            assert is_package(name), f"{where}: {name} is not a face"
            listed = face_of(load(name))
            for alias in node.names:
                is_module = (ROOT / name.replace(".", "/") / f"{alias.name}.py").exists()
                is_part = is_package(f"{name}.{alias.name}")
                assert alias.name in listed or is_module or is_part, (
                    f"{where}: {alias.name} is not in the face of {name}"
                )


FACES = sorted(
    module_of(f)
    for f in FILES
    if f.name == "__init__.py"
    and module_of(f).count(".") <= 1
    and not module_of(f).startswith("matstd")
    and module_of(f) not in ALLOWED
)


@pytest.mark.parametrize("name", FACES)
def test_faces_are_short_and_true(name: str) -> None:
    face = load(name)
    assert ast.get_docstring(ast.parse(Path(str(face.__file__)).read_text(encoding="utf-8")))
    names = face_of(face)
    assert len(names) in FACE, len(names)
    for name in names:
        assert getattr(face, name) is not None, name


@pytest.mark.parametrize("room", PARTS)
def test_parts_are_complete(room: str) -> None:
    """What a room lists as its parts are its folders, and the installed packages are all there."""
    folders = {f.parent.name for f in (ROOT / room).glob("*/__init__.py")}
    assert set(PARTS[room]) == folders
    packages = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))
    listed = packages["tool"]["setuptools"]["packages"]
    assert {f"matstd.{room}", *(f"matstd.{room}.{part}" for part in folders)} <= set(listed)
    assert packages["tool"]["setuptools"]["package-dir"][f"matstd.{room}"] == room


@pytest.mark.parametrize("name", FACES)
def test_no_module_bears_the_name_of_what_its_face_exports(name: str) -> None:
    """`from part import word` would give the module or the function, as imports happened to run."""
    modules = {f.stem for f in (ROOT / name.replace(".", "/")).glob("*.py")}
    assert not modules & set(face_of(load(name)))


def text_of(node: ast.AST) -> str:
    """A string constant, or the fixed letters of an f-string; "" for anything else."""
    if isinstance(node, ast.Constant) and isinstance(node.value, str):
        return node.value
    if isinstance(node, ast.JoinedStr):
        return "".join(text_of(v) or "{}" for v in node.values)
    return ""


def prose_with_units(tree: ast.Module) -> list[tuple[str, int]]:
    """Texts of three words and more that name a unit, but for docstrings, refusals and cards."""
    passed: set[int] = set()
    for node in nodes_of(tree):
        is_docstring = isinstance(node, ast.Expr) and bool(text_of(node.value))
        is_card = isinstance(node, ast.keyword) and node.arg in CARDS
        if isinstance(node, ast.Raise) or is_docstring or is_card:
            passed |= {id(n) for n in ast.walk(node)}
        elif isinstance(node, ast.JoinedStr):
            passed |= {id(n) for n in ast.walk(node) if n is not node}
    found = [(text_of(n), n.lineno) for n in nodes_of(tree) if id(n) not in passed and text_of(n)]
    return [(text, line) for text, line in found if UNIT.search(text) and len(text.split()) > 2]


@pytest.mark.parametrize("room", BELOW)
def test_prose_lives_in_the_report(room: str) -> None:
    """Results below `report` carry numbers and names; sentences with units are made there."""
    for file in IN_ROOM[room]:
        name = file.relative_to(ROOT).as_posix()
        found = prose_with_units(tree_of(file))
        if name in EXCUSED:
            assert found, f"{name} has no prose any more: take it off the list"
        else:
            assert not found, f"{name}: {found}"


def test_benchmarks_are_run_by_their_names() -> None:
    runs = runpy.run_path(str(ROOT / "benchmarks" / "__main__.py"))
    assert all((ROOT / "benchmarks" / f"{name}.py").exists() for name in runs["RUNS"])
    with pytest.raises(SystemExit, match=r"jacobian: no benchmark; expected one of .* jacobians, "):
        runs["main"](["jacobian"])


@pytest.mark.parametrize("folder", ["examples", "benchmarks"])
def test_examples_and_benchmarks_enter_by_faces(folder: str) -> None:
    for file in sorted((ROOT / folder).rglob("*.py")):
        for node in ast.walk(ast.parse(file.read_text(encoding="utf-8"))):
            if not isinstance(node, ast.ImportFrom):
                continue
            name = in_house(node.module or "")
            if name.split(".")[0] in PARTS:
                assert name in VOCABULARY or is_package(name), f"{file}:{node.lineno}: {name}"
                listed = face_of(load(name))
                for alias in node.names:
                    assert name in VOCABULARY or alias.name in listed, f"{file}: {alias.name}"


EFFECTS = ("twin.effects", "twin.thermal", "twin.elastic", "twin.laws")
"""Parts that define effects."""


def questions(tree: ast.Module) -> list[tuple[str, int]]:
    """What a file asks by class or by a string: names in `isinstance`, `match`; flags by name."""
    found = []
    for node in nodes_of(tree):
        if isinstance(node, ast.MatchClass):
            found.append((ast.unparse(node.cls), node.lineno))
        if not isinstance(node, ast.Call) or len(node.args) < 2:
            continue
        if ast.unparse(node.func) in ("isinstance", "issubclass"):
            names = (n for n in ast.walk(node.args[1]) if isinstance(n, ast.Name | ast.Attribute))
            found += [(ast.unparse(n).split(".")[-1], node.lineno) for n in names]
        if ast.unparse(node.func) in ("getattr", "hasattr"):
            found.append((text_of(node.args[1]), node.lineno))
    return found


def test_nothing_is_overwritten_unasked() -> None:
    """Whatever takes `force` does without; an empty text is a help that another one replaces."""
    for file in FILES:
        for node in nodes_of(tree_of(file)):
            if not isinstance(node, ast.FunctionDef):
                continue
            named = (*node.args.posonlyargs, *node.args.args)
            stated = dict(zip(reversed(named), reversed(node.args.defaults), strict=False))
            stated |= zip(node.args.kwonlyargs, node.args.kw_defaults, strict=True)
            given = [value for one, value in stated.items() if one.arg == "force" and value]
            assert all(ast.unparse(value) in ("False", "''") for value in given), (
                f"{file}: {node.name}"
            )


def test_effects_are_asked_by_their_traits() -> None:
    """Above the twin nothing depends on which class an effect is of."""
    from matstd.twin.model import Traits

    parts = [f for f in IN_ROOM["twin"] if part_of(module_of(f)) in EFFECTS]
    classes = {n.name for f in parts for n in tree_of(f).body if isinstance(n, ast.ClassDef)}
    flags = {*Traits.__dataclass_fields__, "inner", "tuned", "tuning", "parameters", "terms"}
    assert len(classes) > 30
    for room in ALLOWED.keys() - {"twin"}:
        for file in IN_ROOM[room]:
            own = {n.name for n in tree_of(file).body if isinstance(n, ast.ClassDef)}
            for name, line in questions(tree_of(file)):
                assert name not in (classes - own) | flags, f"{file}:{line}: asks for {name}"


@pytest.mark.parametrize(
    "name",
    ["twin/thermal/thermal_expansion.py", "matstd/templates/effect.txt", "examples/my_effects.py"],
)
def test_a_simple_effect_is_a_page(name: str) -> None:
    """One multiplication with its card and imports; what users begin with."""
    assert len((ROOT / name).read_text(encoding="utf-8").splitlines()) <= 40


def test_folders_are_small() -> None:
    for folder in {f.parent for f in FILES}:
        count = len(list(folder.glob("*.py")))
        assert count <= MAX_FILES, f"{folder}: {count} files"


@pytest.mark.parametrize("room", ALLOWED)
def test_heavy_libraries_are_imported_where_they_are_used(room: str) -> None:
    for file in IN_ROOM[room]:
        tree = tree_of(file)
        is_kernel = file.relative_to(ROOT).as_posix() in KERNEL
        for name, line in top_level_imports(tree):
            is_light = name.split(".")[0] not in HEAVY
            assert is_light or (is_kernel and name.startswith("OCP")), f"{file}:{line}: at the top"
        for node in () if is_kernel else tree.body:
            module = in_house(f"{getattr(node, 'module', '')}").replace(".", "/") + ".py"
            assert module not in KERNEL, f"{file}:{node.lineno}: loads the CAD kernel"
        for name, line in imports(tree):
            top = name.split(".")[0]
            assert room == "cad_out" or top not in {"build123d", "OCP"}, f"{file}:{line}: {name}"
            assert room == "report" or top not in DRAWING, f"{file}:{line}: {name} below report"


@pytest.mark.parametrize("room", ALLOWED)
def test_files_and_functions_stay_readable(room: str) -> None:
    for file in IN_ROOM[room]:
        assert file.read_text(encoding="utf-8").count("\n") <= MAX_LINES, file
        assert ast.get_docstring(tree_of(file)), f"{file}: no docstring"
        for node in nodes_of(tree_of(file)):
            if isinstance(node, ast.FunctionDef):
                doc = ast.get_docstring(node) or ""
                size = (node.end_lineno or 0) - node.lineno - (doc.count("\n") + 1 if doc else 0)
                assert size <= MAX_CODE, f"{file}: {node.name}: {size} lines of code"


def test_scipy_is_loaded_by_no_import_of_the_twin() -> None:
    """A function that needs a solver of it imports that by itself; its statistics none does."""
    for file in (ROOT / "twin").rglob("*.py"):
        text = file.read_text(encoding="utf-8")
        assert not re.search(r"^(import|from) scipy", text, re.MULTILINE), file
        assert "scipy.stats" not in text, file


def test_help_is_light() -> None:
    """Help answers without numpy, and a wrong command without a traceback."""
    code = (
        "import sys; from matstd.cli import main\n"
        "try: main(['--help'])\n"
        "except SystemExit: pass\n"
        "heavy = {'numpy','scipy','pydantic','rich','build123d','pyvista'} & set(sys.modules)\n"
        "assert not heavy, heavy"
    )
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stderr
    assert "diagnose" in done.stdout


def test_every_command_has_its_file() -> None:
    from matstd.cli import FOLDERS

    place = ROOT / "matstd" / "commands"
    for folder, names in FOLDERS.items():
        for name in names:
            assert (place / folder / f"{name.replace('-', '_')}.py").exists(), name


MAX_PLACES = 4
"""Fields of a record that may be given by place: of more, a reader cannot see which is which."""


def records(tree: ast.AST) -> dict[str, int]:
    """Data classes and named tuples of a file, with their numbers of fields."""
    found = {}
    for node in nodes_of(tree):
        if isinstance(node, ast.ClassDef):
            marks = [ast.unparse(n) for n in (*node.decorator_list, *node.bases)]
            if any(mark.startswith(("dataclass", "NamedTuple")) for mark in marks):
                found[node.name] = sum(isinstance(b, ast.AnnAssign) for b in node.body)
    return found


def test_long_records_are_built_by_keyword() -> None:
    sizes: dict[str, int] = {}
    for file in FILES:
        sizes |= records(tree_of(file))
    found = [
        f"{file}:{node.lineno}: {node.func.id}"
        for file in FILES
        for node in nodes_of(tree_of(file))
        if isinstance(node, ast.Call)
        and isinstance(node.func, ast.Name)
        and sizes.get(node.func.id, 0) > MAX_PLACES
        and len(node.args) > MAX_PLACES
    ]
    assert len(sizes) > 200
    assert not found, found
