"""The architecture as a test: floors, heavy imports, sizes, start-up, words that do not belong."""

import ast
import subprocess
import sys
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[1]
ALLOWED = {
    "twin": set(),
    "sensitivity": {"twin"},
    "artefact": {"twin", "sensitivity"},
    "diagnosis": {"twin", "sensitivity"},
    "cad_out": {"twin", "artefact"},
    "probe_paths": {"twin", "artefact"},
    "matstd": {
        "twin",
        "sensitivity",
        "artefact",
        "diagnosis",
        "cad_out",
        "probe_paths",
    },
}
HEAVY = {"build123d", "OCP", "pyvista", "vtk", "matplotlib", "trimesh", "manifold3d"}
# The kernel's own files name forty of its classes each; they are imported inside functions only.
KERNEL = {"cad_out/solid.py", "cad_out/faces.py", "cad_out/exchange.py"}
MAX_LINES = 400
MAX_CODE = 60

FILES = [f for room in ALLOWED for f in sorted((ROOT / room).rglob("*.py"))]
IDS = [str(f.relative_to(ROOT)) for f in FILES]


def imports(tree: ast.AST) -> list[tuple[str, int]]:
    """First words of all imported modules with their line."""
    found = []
    for node in ast.walk(tree):
        if isinstance(node, ast.Import):
            found += [(alias.name.split(".")[0], node.lineno) for alias in node.names]
        elif isinstance(node, ast.ImportFrom) and node.module and not node.level:
            found.append((node.module.split(".")[0], node.lineno))
    return found


def top_level_imports(tree: ast.Module) -> list[tuple[str, int]]:
    """The same without those inside functions and `if TYPE_CHECKING:`."""
    body = [n for n in tree.body if isinstance(n, ast.Import | ast.ImportFrom)]
    return imports(ast.Module(body=body, type_ignores=[]))


@pytest.mark.parametrize("file", FILES, ids=IDS)
def test_imports_run_one_way(file: Path) -> None:
    room = file.relative_to(ROOT).parts[0]
    tree = ast.parse(file.read_text(encoding="utf-8"))
    for name, line in imports(tree):
        assert name not in ALLOWED or name == room or name in ALLOWED[room], (
            f"{file}:{line}: {room} imports {name}"
        )


@pytest.mark.parametrize("file", FILES, ids=IDS)
def test_heavy_libraries_are_imported_where_they_are_used(file: Path) -> None:
    tree = ast.parse(file.read_text(encoding="utf-8"))
    is_kernel = file.relative_to(ROOT).as_posix() in KERNEL
    for name, line in top_level_imports(tree):
        allowed = is_kernel and name == "OCP"
        assert allowed or name not in HEAVY, f"{file}:{line}: {name} at the top of the file"
    if not is_kernel:
        for node in tree.body:
            module = f"{getattr(node, 'module', '')}".replace(".", "/") + ".py"
            assert module not in KERNEL, f"{file}:{node.lineno}: loads the CAD kernel"
    if file.relative_to(ROOT).parts[0] != "cad_out":
        for name, line in imports(tree):
            assert name not in {"build123d", "OCP"}, f"{file}:{line}: {name} outside cad_out"


@pytest.mark.parametrize("file", FILES, ids=IDS)
def test_files_and_functions_stay_readable(file: Path) -> None:
    text = file.read_text(encoding="utf-8")
    assert text.count("\n") <= MAX_LINES
    tree = ast.parse(text)
    assert ast.get_docstring(tree), "no docstring"
    for node in ast.walk(tree):
        if isinstance(node, ast.FunctionDef):
            doc = ast.get_docstring(node) or ""
            size = (node.end_lineno or 0) - node.lineno - (doc.count("\n") + 1 if doc else 0)
            assert size <= MAX_CODE, f"{node.name}: {size} lines of code"


def test_scipy_stats_stays_out_of_the_twin() -> None:
    for file in (ROOT / "twin").rglob("*.py"):
        assert "scipy" not in file.read_text(encoding="utf-8"), file


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
    from matstd.cli import COMMANDS

    for name in COMMANDS:
        assert (ROOT / "matstd" / "commands" / f"{name}.py").exists(), name
