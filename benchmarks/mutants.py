"""Would the tests notice?   python benchmarks/mutants.py     (make mutants)

Makes 200 random lines of the production code wrong, one at a time, and runs the tests that execute
the line until one fails. Prints the share of wrong lines that a test noticed and every line that
none did. A first run of all tests, with probes at these lines alone and so at its usual speed,
records which test executes which line; a test that fails in it is not used.

A wrong line has one change: a comparison or condition turned round, + for -, * for /, a sign, `and`
for `or`, a number (n + 1, or twice a fraction), True for False, a call left out. Each is drawn from
all such places with equal chance; the seed fixes the draw.
"""

import argparse
import ast
import json
import os
import random
import re
import shutil
import subprocess
import sys
import tempfile
import tomllib
from collections import Counter, defaultdict
from collections.abc import Iterator
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path
from queue import Queue
from typing import NamedTuple

ROOT = Path(__file__).parents[1]
sys.path.insert(0, str(ROOT / "tests"))

from check_types import link_folder  # noqa: E402

PROJECT = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))
ROOMS: dict[str, str] = PROJECT["tool"]["setuptools"]["package-dir"]
MOST_FILES = 8
"""The same where tests are chosen by what they import."""
TIMEOUT = 600.0
"""Seconds after which a wrong line counts as missed: busy cores may keep the tests from ending."""
MOST_TESTS, MOST_SECONDS = 150, 60.0
"""Tests that one wrong line is shown to, and their time: the share that is printed is a lower bound
where more execute it."""
OPPOSITE = {
    ast.Lt: ">=", ast.LtE: ">", ast.Gt: "<=", ast.GtE: "<", ast.Eq: "!=", ast.NotEq: "==",
    ast.In: "not in", ast.NotIn: "in", ast.Is: "is not", ast.IsNot: "is",
    ast.Add: "-", ast.Sub: "+", ast.Mult: "/", ast.Div: "*", ast.FloorDiv: "/",
    ast.And: "or", ast.Or: "and",
}  # fmt: skip


class Mutant(NamedTuple):
    """One wrong line.

    Attributes:
        file: Path from the root of the project.
        line: Its number, from 1.
        start: Column of the change in the line, and its end.
        end: The end of the change.
        text: What stands there instead.
    """

    file: str
    line: int
    start: int
    end: int
    text: str

    def apply(self, source: str) -> str:
        """The source with this one change."""
        lines = source.splitlines(keepends=True)
        raw = lines[self.line - 1].encode()
        lines[self.line - 1] = (raw[: self.start] + self.text.encode() + raw[self.end :]).decode()
        return "".join(lines)


def replaced(node: ast.expr) -> str | None:
    """Source of an expression with one thing wrong in it; None for what has no opposite."""
    match node:
        case ast.Compare(ops=[op]) if type(op) in OPPOSITE:
            left, right = ast.unparse(node.left), ast.unparse(node.comparators[0])
            return f"({left} {OPPOSITE[type(op)]} {right})"
        case ast.BinOp(op=op) if type(op) in OPPOSITE:
            is_text = any(isinstance(n, ast.JoinedStr | ast.Constant) and not is_number(n)
                          for n in (node.left, node.right))  # fmt: skip
            left, right = f"({ast.unparse(node.left)})", f"({ast.unparse(node.right)})"
            return None if is_text else f"({left} {OPPOSITE[type(op)]} {right})"
        case ast.BoolOp(op=op, values=values):
            return "(" + f" {OPPOSITE[type(op)]} ".join(f"({ast.unparse(v)})" for v in values) + ")"
        case ast.UnaryOp(op=ast.USub() | ast.Not()):
            return f"({ast.unparse(node.operand)})"
        case ast.Constant(value=bool(value)):
            return str(not value)
        case ast.Constant(value=int(value)) if is_number(node):
            return str(value + 1)
        case ast.Constant(value=float(value)):
            return repr(2.0 * value if value else 1.0)
    return None


def is_number(node: ast.AST) -> bool:
    """Whether a node is a number that is written out."""
    value = getattr(node, "value", None)
    return isinstance(node, ast.Constant) and isinstance(value, int | float) and value is not True


def one_line(node: ast.expr | ast.stmt) -> bool:
    """Whether a node begins and ends on one line."""
    return node.lineno == node.end_lineno


def passed_over(tree: ast.Module) -> set[int]:
    """Ids of nodes whose change no test can or should notice: types, texts, `__all__`, raises."""
    out: set[int] = set()
    for node in ast.walk(tree):
        parts: list[ast.AST | None] = []
        match node:
            case ast.keyword(arg="strict" | "check"):  # a second look at what is always so
                parts = [node]
            case ast.ClassDef():
                parts = [*node.decorator_list]
            case ast.FunctionDef():
                parts = [node.returns, *node.decorator_list]
                parts += [a.annotation for a in ast.walk(node.args) if isinstance(a, ast.arg)]
            case ast.AnnAssign():
                parts = [node.annotation]
            case ast.JoinedStr() | ast.Raise() | ast.Import() | ast.ImportFrom():
                parts = [node]
            case ast.If(test=ast.Name(id="TYPE_CHECKING")):
                parts = [node]
            case ast.Subscript():
                parts = [] if any(is_number(n) for n in ast.walk(node.slice)) else [node.slice]
        out |= {id(n) for part in parts if part is not None for n in ast.walk(part)}
    return out


def mutants_of(file: Path) -> Iterator[Mutant]:
    """Every wrong line that one file can have."""
    tree = ast.parse(file.read_text(encoding="utf-8"))
    skip, name = passed_over(tree), file.relative_to(ROOT).as_posix()
    for node in ast.walk(tree):
        if id(node) in skip:
            continue
        if isinstance(node, ast.Expr) and isinstance(node.value, ast.Call) and one_line(node):
            yield Mutant(name, node.lineno, node.col_offset, node.end_col_offset or 0, "pass")
        elif isinstance(node, ast.expr) and one_line(node) and (text := replaced(node)):
            yield Mutant(name, node.lineno, node.col_offset, node.end_col_offset or 0, text)


def drawn(count: int, seed: int, rooms: list[str]) -> list[Mutant]:
    """Random wrong lines, of every line one at most."""
    files = [f for room in rooms for f in sorted((ROOT / room).rglob("*.py"))]
    by_line: dict[tuple[str, int], list[Mutant]] = defaultdict(list)
    for mutant in (m for f in files if "beside" not in f.parts for m in mutants_of(f)):
        by_line[mutant.file, mutant.line].append(mutant)
    rng = random.Random(seed)
    lines = rng.sample(sorted(by_line), min(count, len(by_line)))
    return [rng.choice(by_line[line]) for line in lines]


class Trace(NamedTuple):
    """What a run of all tests recorded.

    Attributes:
        tests: Tests that execute a wrong line, by the number of the line in the draw.
        seconds: How long each test takes by itself.
        shared: The fixtures that it shares with others, and the seconds of each.
    """

    tests: dict[int, set[str]]
    seconds: dict[str, float]
    shared: dict[str, dict[str, float]]

    def chosen(self, number: int, mutant: Mutant) -> list[str]:
        """Tests for a wrong line: its room first, short ones first, until `MOST_SECONDS`.

        Those of its room where none is recorded: what only an import executes.
        """
        room = f"tests/{mutant.file.split('/')[0]}/"
        possible = self.tests.get(number) or {t for t in self.seconds if t.startswith(room)}
        cost = {t: self.seconds[t] + sum(self.shared[t].values()) for t in possible}
        order = sorted(possible, key=lambda t: (not t.startswith(room), cost[t], t))
        out, ready, spent = [], set(), 0.0
        for test in order[:MOST_TESTS]:
            shared = self.shared[test]
            spent += self.seconds[test] + sum(v for k, v in shared.items() if k not in ready)
            if out and spent > MOST_SECONDS:
                break
            out.append(test)
            ready |= set(shared)
        return out


class Imports:
    """Tests for a wrong line by what they import, where no run records what they execute."""

    def __init__(self) -> None:
        folders = {name.removeprefix("matstd."): place for name, place in ROOMS.items()}
        self.modules: dict[str, Path] = {}
        for name, place in {**folders, "": "matstd"}.items():
            for file in (ROOT / place).rglob("*.py"):
                parts = ("matstd", name, *file.relative_to(ROOT / place).with_suffix("").parts)
                self.modules[".".join(p for p in parts if p and p != "__init__")] = file
        self.edges = {name: self.imported(file) for name, file in self.modules.items()}
        self.tests = {
            file.relative_to(ROOT).as_posix(): self.imported(file)
            for file in sorted((ROOT / "tests").rglob("test_*.py"))
        }

    def imported(self, file: Path) -> set[str]:
        """Modules of the project that a file imports, with the module that defines each name."""
        tree, out = ast.parse(file.read_text(encoding="utf-8")), set()
        for node in ast.walk(tree):
            if isinstance(node, ast.ImportFrom) and node.module:
                out |= {self.defining(node.module, alias.name) for alias in node.names}
            elif isinstance(node, ast.Import):
                out |= {alias.name for alias in node.names}
        return out & set(self.modules)

    def defining(self, module: str, name: str) -> str:
        """The module that defines what another offers as its face."""
        if f"{module}.{name}" in self.modules:
            return f"{module}.{name}"
        file = self.modules.get(module)
        if file is None or file.name != "__init__.py":
            return module
        for node in ast.parse(file.read_text(encoding="utf-8")).body:
            is_offered = isinstance(node, ast.ImportFrom) and node.module not in (None, module)
            if is_offered and any(alias.name == name for alias in node.names):
                return self.defining(node.module, name)
        return module

    def chosen(self, number: int, mutant: Mutant) -> list[str]:
        """Test files for a wrong line: those that import its module most directly, short first."""
        (module,) = [n for n, file in self.modules.items() if file == ROOT / mutant.file]
        far, users = {module: 0}, {module}
        while users:
            near = {n for n, found in self.edges.items() if found & users} - set(far)
            far |= dict.fromkeys(near, max(far.values()) + 1)
            users = near
        room, file = f"tests/{mutant.file.split('/')[0]}/", ROOT / mutant.file
        # a command and an example are run by their names
        name = re.compile(rf"\b({file.stem}|{file.parent.name})\b")
        steps: dict[str, int] = {}
        for test, found in self.tests.items():
            steps_to = [far[n] for n in found if n in far]
            if steps_to or name.search((ROOT / test).read_text(encoding="utf-8")):
                steps[test] = min(steps_to, default=9)
        order = sorted(
            steps, key=lambda t: (steps[t], not t.startswith(room), (ROOT / t).stat().st_size)
        )
        return order[:MOST_FILES]


class Probes(ast.NodeTransformer):
    """Reports which lines of a draw are executed: `seen(7) or x` in the place of `x`.

    A default and a constant of a module are executed when they are imported: the functions that
    have the one or read the other report them.
    """

    def __init__(self, numbers: dict[tuple[int, int, int], int]) -> None:
        self.numbers = numbers  # by line, start and end in the line

    def visit(self, node: ast.AST) -> ast.AST:
        """The node with the probes in it."""
        self.generic_visit(node)
        number = self.number(node)
        if number is not None and isinstance(node, ast.expr):
            return ast.BoolOp(ast.Or(), [probe(number), node])
        if isinstance(node, ast.FunctionDef):
            has_text = ast.get_docstring(node) is not None
            node.body[has_text:has_text] = [ast.Expr(probe(n)) for n in self.imported_by(node)]
        return node

    def number(self, node: ast.AST) -> int | None:
        """The number of a node in the draw."""
        place = (getattr(node, name, -1) for name in ("lineno", "col_offset", "end_col_offset"))
        return self.numbers.get(tuple(place))  # type: ignore[arg-type]

    def constants(self, tree: ast.Module) -> "Probes":
        """Remembers the names of the module whose values are in the draw."""
        self.names: dict[str, list[int]] = defaultdict(list)
        for node in tree.body:
            if isinstance(node, ast.Assign | ast.AnnAssign) and node.value is not None:
                found = self.within(node.value)
                targets = node.targets if isinstance(node, ast.Assign) else [node.target]
                for name in (n.id for t in targets for n in ast.walk(t) if isinstance(n, ast.Name)):
                    self.names[name] += found
        return self

    def within(self, tree: ast.AST) -> list[int]:
        """The numbers of all nodes of a tree that are in the draw."""
        return [n for node in ast.walk(tree) if (n := self.number(node)) is not None]

    def imported_by(self, function: ast.FunctionDef) -> set[int]:
        """Lines of the draw that the import executes for a function."""
        out = set(self.within(function.args))
        for node in ast.walk(function):
            if isinstance(node, ast.Name):
                out |= set(self.names.get(node.id, ()))
        return out


def probe(number: int) -> ast.Call:
    """Reports that a line is executed; returns None."""
    return ast.Call(ast.Name("_seen", ast.Load()), [ast.Constant(number)], [])


def probed(source: str, mutants: dict[int, Mutant]) -> str:
    """The source with probes at its lines of the draw; as it is where a loop is compiled."""
    tree = ast.parse(source)
    if any(isinstance(n, ast.Name) and n.id == "compiled_loop" for n in ast.walk(tree)):
        return source
    patterns = {id(p) for n in ast.walk(tree) if isinstance(n, ast.pattern) for p in ast.walk(n)}
    places = {
        (n.lineno, n.col_offset, n.end_col_offset or 0)
        for n in ast.walk(tree)
        if isinstance(n, ast.expr) and one_line(n) and id(n) not in patterns
    }
    numbers = {(m.line, m.start, m.end): k for k, m in mutants.items()}
    probes = Probes({place: k for place, k in numbers.items() if place in places})
    # other processes, which record nothing, run the same sources
    head = ast.parse("import builtins as _b\n_seen = getattr(_b, '_seen', lambda number: None)")
    made = probes.constants(tree).visit(tree)
    assert isinstance(made, ast.Module)
    first = next(
        (k for k, n in enumerate(made.body)
         if not (isinstance(n, ast.Expr) and isinstance(n.value, ast.Constant))
         and not (isinstance(n, ast.ImportFrom) and n.module == "__future__")), 0,
    )  # fmt: skip
    made.body[first:first] = head.body
    return ast.unparse(ast.fix_missing_locations(made)) + "\n"


def traced(folder: Path, mutants: list[Mutant], jobs: int) -> Trace:
    """Runs all tests once with probes at the lines, or reads what an earlier run left."""
    if not list(folder.glob("*.json")):
        folder.mkdir(parents=True, exist_ok=True)
        with tempfile.TemporaryDirectory() as place:
            record(Copy(Path(place)), mutants, folder, jobs)
    seconds: dict[str, float] = {}
    shared: dict[str, dict[str, float]] = {}
    tests: dict[int, set[str]] = defaultdict(set)
    for file in folder.glob("*.json"):
        part = json.loads(file.read_text())
        passed = [t for t in part["seconds"] if t not in part["failed"]]
        for test in passed:
            seconds[test] = part["seconds"][test]
            made = [f for f in part["uses"][test] if f in part["fixture_seconds"]]
            shared[test] = {f: part["fixture_seconds"][f] for f in made}
            for number in {*part["seen"][test], *(n for f in made for n in part["fixtures"][f])}:
                tests[number].add(test)
    if not seconds:
        sys.exit(f"no test passed: remove {folder} and see what the tests report")
    return Trace(tests, seconds, shared)


def record(copy: "Copy", mutants: list[Mutant], folder: Path, jobs: int) -> None:
    """Runs all tests of a copy of the project, with probes."""
    by_file: dict[str, dict[int, Mutant]] = defaultdict(dict)
    for number, mutant in enumerate(mutants):
        by_file[mutant.file][number] = mutant
    for name, some in by_file.items():
        copy.write(name, probed((copy.root / name).read_text(encoding="utf-8"), some))
    # tests that read the sources fail here; those that fail are shown no wrong line
    subprocess.run(
        [sys.executable, "-m", "pytest", "-q", "-p", "traced_tests", "-n", str(jobs), "tests"],
        cwd=copy.root,
        env=copy.environment(TRACED=str(folder)),
        check=False,
    )


class Copy:
    """A copy of the project in which one line at a time is wrong."""

    def __init__(self, place: Path) -> None:
        self.root, self.writes = place / "project", 1_000_000_000
        self.passed: set[str] = set()
        listed = subprocess.run(
            ["git", "ls-files", "-z"], cwd=ROOT, capture_output=True, check=True
        )
        for name in filter(None, listed.stdout.decode().split("\0")):
            if (ROOT / name).exists():
                (self.root / name).parent.mkdir(parents=True, exist_ok=True)
                shutil.copyfile(ROOT / name, self.root / name)
        # tests ask git for the files of the project
        subprocess.run(["git", "init", "-q"], cwd=self.root, check=True)
        subprocess.run(["git", "add", "-A"], cwd=self.root, check=True)
        for name, folder in ROOMS.items():  # found before the checkout, as if installed
            link_folder(self.root / name.replace(".", "/"), self.root / folder)

    def write(self, name: str, text: str) -> None:
        """A file of the copy, newer by a second each time: Python compiles it anew."""
        self.writes += 1
        (self.root / name).write_text(text, encoding="utf-8")
        os.utime(self.root / name, (self.writes, self.writes))

    def environment(self, **more: str) -> dict[str, str]:
        """The environment in which the copy is found before the checkout."""
        path = [str(self.root), str(ROOT / "benchmarks"), os.environ.get("PYTHONPATH", "")]
        return os.environ | {"PYTHONPATH": os.pathsep.join(path)} | more

    def notices(self, mutant: Mutant, tests: list[str]) -> bool:
        """Whether a test fails with a wrong line and passes without it."""
        right = (self.root / mutant.file).read_text(encoding="utf-8")
        self.write(mutant.file, mutant.apply(right))
        try:
            failed = self.first_failure(tests)
        except subprocess.TimeoutExpired:
            return False
        finally:
            self.write(mutant.file, right)
        if failed and failed not in self.passed:
            if self.first_failure([failed]):
                sys.exit(f"{failed} fails with every line right: it cannot notice a wrong one")
            self.passed.add(failed)
        return bool(failed)

    def first_failure(self, tests: list[str]) -> str:
        """The first test that fails, or the first of all where none could begin; empty for none."""
        if not tests:
            return ""
        done = subprocess.run(
            [sys.executable, "-m", "pytest", "-x", "-q", "-n", "0", "-p", "traced_tests", *tests],
            cwd=self.root,
            env=self.environment(),
            capture_output=True,
            text=True,
            timeout=TIMEOUT,
            check=False,
        )
        if done.returncode in (0, 5):
            return ""
        named = re.findall(r"^(?:FAILED|ERROR) (.+?)(?: - |$)", done.stdout, flags=re.MULTILINE)
        return named[0] if named else tests[0]


def interval(killed: int, count: int) -> tuple[float, float]:
    """The share's interval of 95 % by Wilson's score."""
    z, p = 1.96, killed / count
    middle, half = p + z**2 / (2 * count), z * (p * (1 - p) / count + z**2 / (4 * count**2)) ** 0.5
    return (middle - half) / (1 + z**2 / count), (middle + half) / (1 + z**2 / count)


def main() -> None:
    """Draw, run and report."""
    parser = argparse.ArgumentParser(description=(__doc__ or "").partition("\n")[0])
    parser.add_argument("-n", type=int, default=200, help="wrong lines")
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--jobs", type=int, default=2)
    parser.add_argument("--rooms", nargs="+", help="draw from these alone; all without it")
    parser.add_argument("--most", type=int, help="try the first of the lines alone")
    parser.add_argument(
        "--by-import", action="store_true", help="choose tests by what they import: no first run"
    )
    parser.add_argument("--trace", type=Path, help="folder of what the first run records")
    options = parser.parse_args()
    rooms = options.rooms or [*ROOMS.values(), "matstd"]
    mutants = drawn(options.n, options.seed, rooms)
    name = "-".join(["traced", str(options.seed), str(options.n), *(options.rooms or [])])
    folder = options.trace or ROOT / "build" / name
    trace = Imports() if options.by_import else traced(folder, mutants, options.jobs)
    tried_ones = list(enumerate(mutants))[: options.most]
    noticed: dict[Mutant, bool] = {}
    copies: Queue[Copy] = Queue()
    with tempfile.TemporaryDirectory() as place:
        for k in range(options.jobs):
            copies.put(Copy(Path(place) / str(k)))

        def tried(one: tuple[int, Mutant]) -> None:
            mutant, copy = one[1], copies.get()
            noticed[mutant] = copy.notices(mutant, trace.chosen(*one))
            copies.put(copy)
            word = "noticed" if noticed[mutant] else "MISSED"
            print(f"{len(noticed):4} {word:8} {mutant.file}:{mutant.line}", flush=True)
            if not noticed[mutant]:
                source = (ROOT / mutant.file).read_text(encoding="utf-8")
                for sign, text in (("-", source), ("+", mutant.apply(source))):
                    print(f"     {sign} {text.splitlines()[mutant.line - 1].strip()}", flush=True)

        with ThreadPoolExecutor(options.jobs) as pool:
            list(pool.map(tried, tried_ones))
    killed = sum(noticed.values())
    low, high = interval(killed, len(noticed))
    print(f"\nseed {options.seed}: {killed} of {len(noticed)} wrong lines are noticed, "
          f"{killed / len(noticed):.0%} ({low:.0%} to {high:.0%} with 95 %)")  # fmt: skip
    by_room = Counter(m.file.split("/")[0] for m in noticed)
    for room, count in sorted(by_room.items()):
        found = sum(noticed[m] for m in noticed if m.file.startswith(f"{room}/"))
        print(f"  {room:14} {found:3} of {count}")


if __name__ == "__main__":
    main()
