"""Would the tests notice?   python benchmarks/mutants.py     (make mutants)

Makes 200 random lines of the production code wrong, one at a time, and runs the tests that execute
the line, as one run of all tests under coverage.py recorded, until one fails. Prints the share of
wrong lines that a test noticed and every line that none did.

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
from collections.abc import Iterable, Iterator
from concurrent.futures import ThreadPoolExecutor
from hashlib import sha256
from pathlib import Path
from queue import Queue
from typing import NamedTuple
from xml.etree import ElementTree

from coverage import CoverageData

ROOT = Path(__file__).parents[1]
sys.path.insert(0, str(ROOT / "tests"))

from check_types import link_folder  # noqa: E402

PROJECT = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))
ROOMS: dict[str, str] = PROJECT["tool"]["setuptools"]["package-dir"]
PRODUCTION = [
    f.relative_to(ROOT).as_posix()
    for room in (*ROOMS.values(), "matstd")
    for f in sorted((ROOT / room).rglob("*.py"))
]
MOST_SECONDS = 300.0
"""Seconds of tests that one wrong line is shown to; where more execute it, the share printed is a
lower bound."""
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
            case ast.Call(func=ast.Attribute(attr="reshape")):  # of -2 numpy makes the same
                parts = [n for n in node.args if ast.unparse(n) == "-1"]
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


class Traced:
    """Tests that execute a line, and how long each takes: one run of all under coverage.py."""

    def __init__(self, folder: Path) -> None:
        texts = [
            (ROOT / f).read_bytes() for f in (*PRODUCTION, *sorted(ROOT.glob("tests/**/*.py")))
        ]
        folder /= sha256(b"".join(texts)).hexdigest()[:12]  # lines of other code are others
        store, times = folder / "coverage", folder / "times.xml"
        if not store.exists():
            folder.mkdir(parents=True, exist_ok=True)
            rooms = [f"--cov={room}" for room in (*ROOMS.values(), "matstd")]
            traced = [*rooms, "--cov-context=test", "--cov-report="]
            named = ["-o", "junit_family=xunit1", f"--junitxml={times}"]
            subprocess.run(
                [sys.executable, "-m", "pytest", "-q", *traced, *named],
                cwd=ROOT,
                env=os.environ | {"COVERAGE_FILE": str(store.absolute())},
                check=True,
            )
        self.data = CoverageData(str(store))
        self.data.read()
        self.lines: dict[str, dict[int, list[str]]] = {}
        self.seconds: dict[str, float] = defaultdict(float)
        for case in ElementTree.parse(times).iter("testcase"):
            self.seconds[f"{case.get('file')}::{case.get('name')}"] += float(case.get("time", 0))

    def executing(self, file: str, lines: Iterable[int]) -> set[str]:
        """Tests that execute one of the lines: all of a file whose fixture does."""
        if file not in self.lines:
            self.lines[file] = self.data.contexts_by_lineno(str(ROOT / file))
        contexts = {c for line in lines for c in self.lines[file].get(line, []) if c}
        runs = (c.rpartition("|") for c in contexts)
        return {test if phase == "run" else test.partition("::")[0] for test, _, phase in runs}

    def chosen(self, mutant: Mutant) -> list[str]:
        """Tests that execute a wrong line, of short files first, within `MOST_SECONDS`.

        What is executed at import is a constant or the field of a class, whose users count, not the
        test that imported it first. What only another process executes is tested by what else
        executes a line of its file.
        """
        tree = ast.parse((ROOT / mutant.file).read_text(encoding="utf-8"))
        found = set[str]()
        if in_function(tree, mutant.line):
            found = self.executing(mutant.file, statement_lines(tree, mutant.line))
        else:
            for name in assigned(tree, mutant.line):
                word = re.compile(rf"\b{name}\b")
                for file in PRODUCTION:
                    text = (ROOT / file).read_text(encoding="utf-8").splitlines()
                    lines = [k for k, t in enumerate(text, 1) if word.search(t)]
                    found |= self.executing(file, lines)
        if not found:
            found = self.executing(mutant.file, self.data.lines(str(ROOT / mutant.file)) or [])
        if not in_function(tree, mutant.line):
            found.add("tests/test_formats.py")  # of keys, defaults and thresholds
        by_file: dict[str, list[str]] = defaultdict(list)
        for test in sorted(found):
            by_file[test.partition("::")[0]].append(test)
        cost = {file: self.cost(file, tests) for file, tests in by_file.items()}
        out: list[str] = []
        spent = 0.0
        for file in sorted(by_file, key=lambda f: cost[f]):
            spent += cost[file]
            if out and spent > MOST_SECONDS:
                break
            out += [file] if file in by_file[file] else by_file[file]
        return out

    def cost(self, file: str, tests: list[str]) -> float:
        """Seconds of some tests of a file; its longest may be the one that makes a fixture."""
        own = {test: s for test, s in self.seconds.items() if test.startswith(f"{file}::")}
        if file in tests:
            return sum(own.values())
        return sum(own.get(t, 0.0) for t in tests) + max(own.values(), default=0.0)


def statement_lines(tree: ast.Module, line: int) -> range:
    """Lines of the innermost statement around a line, of one with a body its head alone."""
    best = range(line, line + 1)
    for node in ast.walk(tree):
        if isinstance(node, ast.stmt) and node.lineno <= line <= (node.end_lineno or 0):
            body = getattr(node, "body", None)
            end = body[0].lineno - 1 if body else node.end_lineno or line
            if line <= max(end, node.lineno):
                best = range(node.lineno, max(end, node.lineno) + 1)
    return best


def in_function(tree: ast.Module, line: int) -> bool:
    """Whether a line is executed when a function is called, not at import."""
    return any(
        isinstance(node, ast.FunctionDef) and node.body[0].lineno <= line <= (node.end_lineno or 0)
        for node in ast.walk(tree)
    )


def assigned(tree: ast.Module, line: int) -> list[str]:
    """Names that the statement of a line gives at the top of a module or of a class."""
    classes = [node for node in ast.walk(tree) if isinstance(node, ast.ClassDef)]
    for node in (node for part in (tree, *classes) for node in part.body):
        if isinstance(node, ast.Assign | ast.AnnAssign) and node.lineno <= line <= node.end_lineno:
            goals = node.targets if isinstance(node, ast.Assign) else [node.target]
            return [n.id for goal in goals for n in ast.walk(goal) if isinstance(n, ast.Name)]
    return []


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
        files = list(dict.fromkeys(test.partition("::")[0] for test in tests))
        if done.returncode == 4 and files != tests:  # a name was cut, or the line makes the names
            return self.first_failure(files)
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
    parser.add_argument(
        "--trace", type=Path, default=ROOT / "out" / "traced",
        help="folder of records which tests execute which line, one for every state of the code",
    )  # fmt: skip
    options = parser.parse_args()
    rooms = options.rooms or [*ROOMS.values(), "matstd"]
    mutants = drawn(options.n, options.seed, rooms)
    traced = Traced(options.trace)
    words: dict[Mutant, str] = {}
    copies: Queue[Copy] = Queue()
    with tempfile.TemporaryDirectory() as place:
        for k in range(options.jobs):
            copies.put(Copy(Path(place) / str(k), options.timeout))

        def tried(mutant: Mutant) -> None:
            copy = copies.get()
            try:
                words[mutant] = copy.word(mutant, traced.chosen(mutant))
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
