"""Would the tests notice?   python benchmarks/mutants.py     (make mutants)

Makes 200 random lines of the production code wrong, one at a time, and runs the test files that
import the module of the line most directly, those of its room and short ones first, until one test
fails. Prints the share of wrong lines that a test noticed and every line that none did.

A wrong line has one change: a comparison or condition turned round, + for -, * for /, a sign, `and`
for `or`, a number (n + 1, or twice a fraction), True for False, a call left out. Each is drawn from
all such places with equal chance; the seed fixes the draw.
"""

import argparse
import ast
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
"""Test files that one wrong line is shown to: the share that is printed is a lower bound where more
execute it."""
NOTICED, MISSED, UNDECIDED = "noticed", "MISSED", "undecided"
OPPOSITE = {
    ast.Lt: ">=", ast.LtE: ">", ast.Gt: "<=", ast.GtE: "<", ast.Eq: "!=", ast.NotEq: "==",
    ast.In: "not in", ast.NotIn: "in", ast.Is: "is not", ast.IsNot: "is",
    ast.Add: "-", ast.Sub: "+", ast.Mult: "/", ast.Div: "*", ast.FloorDiv: "/",
    ast.And: "or", ast.Or: "and",
}  # fmt: skip


class Mutant(NamedTuple):
    """One wrong line."""

    file: str  # path from the root of the project
    line: int  # its number, from 1
    start: int  # column of the change in the line, and its end
    end: int  # the end of the change
    text: str  # what stands there instead

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
    """Ids of nodes whose change no test can or should notice: types, texts, raises."""
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


class Imports:
    """Tests for a wrong line by what they import: no traced run of all tests is needed."""

    def __init__(self) -> None:
        folders = {name.removeprefix("matstd."): place for name, place in ROOMS.items()}
        self.modules: dict[str, Path] = {}
        self.faces: dict[Path, list[ast.ImportFrom]] = {}
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
        if file not in self.faces:
            body = ast.parse(file.read_text(encoding="utf-8")).body
            self.faces[file] = [n for n in body if isinstance(n, ast.ImportFrom)]
        for node in self.faces[file]:
            if node.module not in (None, module) and name in [a.name for a in node.names]:
                return self.defining(str(node.module), name)
        return module

    def chosen(self, mutant: Mutant) -> list[str]:
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


class Copy:
    """A copy of the project in which one line at a time is wrong."""

    def __init__(self, place: Path, timeout: float) -> None:
        self.root, self.timeout, self.writes = place / "project", timeout, 1_000_000_000
        self.path = os.pathsep.join([str(self.root), os.environ.get("PYTHONPATH", "")])
        self.passed: set[str] = set()
        self.broken: set[str] = set()
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

    def word(self, mutant: Mutant, tests: list[str]) -> str:
        """Whether a test fails with a wrong line and passes without it, or none ended in time."""
        right = (self.root / mutant.file).read_text(encoding="utf-8")
        while True:
            self.write(mutant.file, mutant.apply(right))
            try:
                failed = self.first_failure(tests)
            except subprocess.TimeoutExpired:
                return UNDECIDED
            finally:
                self.write(mutant.file, right)
            if not failed:
                return MISSED
            if failed in self.broken:
                return UNDECIDED
            if failed in self.passed or self.first_failure([failed]) != failed:
                self.passed.add(failed)
                return NOTICED
            # it fails with every line right, so it says nothing of a wrong one
            self.broken.add(failed)
            print(f"     left out, as it fails with every line right: {failed}", flush=True)

    def first_failure(self, tests: list[str]) -> str:
        """The first test that fails, or the first of all where none could begin; empty for none."""
        if not tests:
            return ""
        left_out = [f"--deselect={name}" for name in sorted(self.broken)]
        done = subprocess.run(
            [sys.executable, "-m", "pytest", "-x", "-q", "-n", "0", *left_out, *tests],
            cwd=self.root,
            env=os.environ | {"PYTHONPATH": self.path},
            capture_output=True,
            text=True,
            timeout=self.timeout,
            check=False,
        )
        if done.returncode in (0, 5):
            return ""
        if done.returncode == 4 and "::" in tests[0]:  # the name was cut at a dash in it
            return self.first_failure([tests[0].partition("::")[0]])
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
    parser.add_argument("--skip", type=int, default=0, help="lines that were tried before")
    parser.add_argument("--most", type=int, help="try so many of the lines alone")
    parser.add_argument(
        "--timeout", type=float, default=600.0, help="seconds after which a line is undecided"
    )
    options = parser.parse_args()
    rooms = options.rooms or [*ROOMS.values(), "matstd"]
    mutants = drawn(options.n, options.seed, rooms)
    imports = Imports()
    words: dict[Mutant, str] = {}
    copies: Queue[Copy] = Queue()
    with tempfile.TemporaryDirectory() as place:
        for k in range(options.jobs):
            copies.put(Copy(Path(place) / str(k), options.timeout))

        def tried(mutant: Mutant) -> None:
            copy = copies.get()
            try:
                words[mutant] = copy.word(mutant, imports.chosen(mutant))
            finally:
                copies.put(copy)
            print(f"{len(words):4} {words[mutant]:9} {mutant.file}:{mutant.line}", flush=True)
            if words[mutant] != NOTICED:
                source = (ROOT / mutant.file).read_text(encoding="utf-8")
                for sign, text in (("-", source), ("+", mutant.apply(source))):
                    print(f"     {sign} {text.splitlines()[mutant.line - 1].strip()}", flush=True)

        with ThreadPoolExecutor(options.jobs) as pool:
            list(pool.map(tried, mutants[options.skip :][: options.most]))
    count = Counter(words.values())
    killed = count[NOTICED]
    low, high = interval(killed, len(words))
    print(f"\nseed {options.seed}: {killed} of {len(words)} wrong lines are noticed, "
          f"{killed / len(words):.0%} ({low:.0%} to {high:.0%} with 95 %), "
          f"{count[MISSED]} missed, {count[UNDECIDED]} undecided")  # fmt: skip
    by_room = Counter(m.file.split("/")[0] for m in words)
    for room, count_of in sorted(by_room.items()):
        found = sum(words[m] == NOTICED for m in words if m.file.startswith(f"{room}/"))
        print(f"  {room:14} {found:3} of {count_of}")


if __name__ == "__main__":
    main()
