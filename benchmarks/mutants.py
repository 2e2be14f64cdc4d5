"""Would the tests notice?   python benchmarks/mutants.py     (make mutants)

Makes 200 random lines of the production code wrong, one at a time, and runs the test files that
execute the line until one test fails. Prints the share of wrong lines that a test noticed and every
line that none did. A first run of all tests records which file executes which lines; it must pass.

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
TIMEOUT = 1800.0
"""Seconds after which a wrong line that keeps the tests from ending counts as noticed.

Long enough for busy cores: a run that is merely slow must not count.
"""
MOST_FILES = 15
"""Test files that one wrong line is shown to: the first of them where all execute it."""
LONG = 10.0
"""Seconds of a test file that is run after the short ones."""
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
        files: Test files that execute a line, by (file, line).
        seconds: How long each test file takes.
    """

    files: dict[tuple[str, int], set[str]]
    seconds: dict[str, float]

    def tests(self, mutant: Mutant) -> list[list[str]]:
        """Test files for a wrong line, short ones, long ones; of its room where none is recorded.

        A constant of a module is executed by no test but when it is imported.
        """
        room = f"tests/{mutant.file.split('/')[0]}/"
        chosen = self.files.get((mutant.file, mutant.line)) or {
            name for name in self.seconds if name.startswith(room)
        }
        order = sorted(chosen, key=lambda name: (not name.startswith(room), self.seconds[name]))
        first = order[:MOST_FILES]
        return [
            [n for n in first if (self.seconds[n] > LONG) == is_long] for is_long in (False, True)
        ]


def traced(folder: Path) -> Trace:
    """Runs all tests once, or reads what an earlier run left in the folder."""
    import coverage

    if not list(folder.glob("seconds-*.json")):
        folder.mkdir(parents=True, exist_ok=True)
        path = os.pathsep.join([str(ROOT / "benchmarks"), os.environ.get("PYTHONPATH", "")])
        done = subprocess.run(
            [sys.executable, "-m", "pytest", "-q", "-p", "traced_tests"],
            cwd=ROOT,
            env=os.environ | {"TRACED": str(folder), "PYTHONPATH": path},
            check=False,
        )
        if done.returncode:
            shutil.rmtree(folder)
            sys.exit("the tests fail as they are: nothing can be learnt from wrong lines")
    seconds: Counter[str] = Counter()
    for file in folder.glob("seconds-*.json"):
        seconds.update(json.loads(file.read_text()))
    files: dict[tuple[str, int], set[str]] = defaultdict(set)
    for part in folder.glob("lines.*"):
        data = coverage.CoverageData(str(part))
        data.read()
        for name in data.measured_files():
            inner = Path(name).relative_to(ROOT).as_posix()
            for line, contexts in data.contexts_by_lineno(name).items():
                files[inner, line] |= {c for c in contexts if c}
    return Trace(files, dict(seconds))


class Copy:
    """A copy of the project in which one line at a time is wrong."""

    def __init__(self, place: Path) -> None:
        self.root, self.writes = place / "project", 1_000_000_000
        self.path = os.pathsep.join([str(self.root), os.environ.get("PYTHONPATH", "")])
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

    def notices(self, mutant: Mutant, tests: list[list[str]]) -> bool:
        """Whether a test fails with a wrong line and passes without it."""
        right = (self.root / mutant.file).read_text(encoding="utf-8")
        for files in filter(None, tests):
            self.write(mutant.file, mutant.apply(right))
            try:
                failed = self.first_failure(files)
            except subprocess.TimeoutExpired:
                return True
            finally:
                self.write(mutant.file, right)
            if failed and failed not in self.passed:
                if self.first_failure([failed]):
                    sys.exit(f"{failed} fails with every line right: it cannot notice a wrong one")
                self.passed.add(failed)
            if failed:
                return True
        return False

    def first_failure(self, tests: list[str]) -> str:
        """The first test that fails, or the first file where none could begin; empty for none."""
        done = subprocess.run(
            [sys.executable, "-m", "pytest", "-x", "-q", "-n", "0", *tests],
            cwd=self.root,
            env=os.environ | {"PYTHONPATH": self.path},
            capture_output=True,
            text=True,
            timeout=TIMEOUT,
            check=False,
        )
        if done.returncode in (0, 5):
            return ""
        named = re.findall(r"^(?:FAILED|ERROR) (.+?)(?: - |$)", done.stdout, flags=re.MULTILINE)
        return named[0] if named else tests[0]


def main() -> None:
    """Draw, run and report."""
    parser = argparse.ArgumentParser(description=(__doc__ or "").partition("\n")[0])
    parser.add_argument("-n", type=int, default=200, help="wrong lines")
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--jobs", type=int, default=2)
    parser.add_argument("--rooms", nargs="+", help="draw from these alone; all without it")
    parser.add_argument("--trace", type=Path, default=ROOT / "build" / "traced")
    options = parser.parse_args()
    rooms = options.rooms or [*ROOMS.values(), "matstd"]
    trace, mutants = traced(options.trace), drawn(options.n, options.seed, rooms)
    noticed: dict[Mutant, bool] = {}
    copies: Queue[Copy] = Queue()
    with tempfile.TemporaryDirectory() as place:
        for k in range(options.jobs):
            copies.put(Copy(Path(place) / str(k)))

        def tried(mutant: Mutant) -> None:
            copy = copies.get()
            noticed[mutant] = copy.notices(mutant, trace.tests(mutant))
            copies.put(copy)
            word = "noticed" if noticed[mutant] else "MISSED"
            print(f"{len(noticed):4} {word:8} {mutant.file}:{mutant.line}", flush=True)
            if not noticed[mutant]:
                source = (ROOT / mutant.file).read_text(encoding="utf-8")
                for sign, text in (("-", source), ("+", mutant.apply(source))):
                    print(f"     {sign} {text.splitlines()[mutant.line - 1].strip()}", flush=True)

        with ThreadPoolExecutor(options.jobs) as pool:
            list(pool.map(tried, mutants))
    killed = sum(noticed.values())
    print(f"\nseed {options.seed}: {killed} of {len(noticed)} wrong lines are noticed, "
          f"{killed / max(len(noticed), 1):.0%}")  # fmt: skip
    by_room = Counter(m.file.split("/")[0] for m in mutants)
    for room, count in sorted(by_room.items()):
        found = sum(noticed[m] for m in mutants if m.file.startswith(f"{room}/"))
        print(f"  {room:14} {found:3} of {count}")


if __name__ == "__main__":
    main()
