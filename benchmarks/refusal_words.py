"""Refusals of damaged TOML files: whose words they are, and whether any is a traceback.

    python benchmarks/refusal_words.py [-n 2000] [--seed 1]

Values, keys and tables of a valid machine, project, error, task and run file are replaced by others
that a user could type. Counts refusals with a word of the validating library in them, and those
that name neither a key nor a line. Ends with 1 if there is any of either, or a traceback.
"""

import argparse
import re
import sys
import tempfile
import tomllib
import traceback
from collections import Counter
from collections.abc import Callable, Iterator
from copy import deepcopy
from pathlib import Path
from typing import Any

import numpy as np

ROOT = Path(__file__).resolve().parents[1]
sys.path[:0] = [str(ROOT / part) for part in (".", "tests/fixtures", "tests/golden")]

from formats import examples  # noqa: E402  (found through the path above)

from matstd.artefact.brief import read_project, read_task  # noqa: E402
from matstd.twin.errors import DesignError  # noqa: E402
from matstd.twin.files import read_errors, read_machine, read_run  # noqa: E402
from matstd.twin.text import toml_value  # noqa: E402

FOREIGN = re.compile(
    r"should (be|have|match|contain)|valid (dictionary|tuple|list|integer|number|string|boolean)"
    r"|instance of|validat|[Pp]ydantic|Field required|Input |literal_error|type=|\bdict\b|NoneType"
)
"""Words of the library that validates."""

VALUES = (
    "abc", "", True, 0.48, -1, 0, 1e9, 7.8, 11.5, [], [1.0], [1.0, 2.0, 3.0, 4.0], ["a", "b"],
    [[1.0]], [True, 2.0], {}, {"a": 1}, [{}], float("nan"), float("inf"), 10**30, "12", [3.0, 1.0],
    [0.0, 0.0], "a\nb", -0.0, 1e-9, [1, "x"], [[1.0, 2.0], [3.0]],
)  # fmt: skip
"""What may stand in place of a value."""


def toml(data: dict[str, Any]) -> str:
    """A TOML text, in inline tables so that anything can stand anywhere."""
    return "".join(f"{_key(k)} = {inline(v)}\n" for k, v in data.items())


def inline(value: Any) -> str:
    """A value in one line."""
    if isinstance(value, dict):
        return "{" + ", ".join(f"{_key(k)} = {inline(v)}" for k, v in value.items()) + "}"
    if isinstance(value, list):
        return "[" + ", ".join(map(inline, value)) + "]"
    return toml_value(value).replace("\n", "\\n")


def _key(name: str) -> str:
    return name if re.fullmatch(r"[\w-]+", name, re.ASCII) else toml_value(name)


def places(data: Any) -> Iterator[tuple[Any, Any]]:
    """Every container with every key or index of it."""
    items = data.items() if isinstance(data, dict) else enumerate(data)
    for key, value in list(items):
        yield data, key
        if isinstance(value, dict | list):
            yield from places(value)


def damaged(rng: np.random.Generator, data: dict[str, Any]) -> dict[str, Any]:
    """A table with one to three values changed, left out, given twice or under another name."""
    for _ in range(int(rng.integers(1, 4))):
        every = [(c, k) for c, k in places(data) if k != "format"]
        where, key = every[int(rng.integers(len(every)))]
        how = rng.choice(["value", "value", "value", "out", "name", "more"])
        if how == "value":
            where[key] = deepcopy(VALUES[int(rng.integers(len(VALUES)))])
        elif how == "out":
            del where[key]
        elif isinstance(where, list):
            where.append(deepcopy(where[key]))
        elif how == "name":
            where[f"{key}s"] = where.pop(key)
        else:
            where[f"{key}_2"] = deepcopy(where[key])
    return data


def run_text(head: dict[str, Any], rows: str) -> str:
    """A run file with another head."""
    return "".join(f"# {line}\n" for line in toml(head).splitlines()) + rows


def main() -> int:
    """Damage, read, count."""
    parser = argparse.ArgumentParser(description=__doc__.partition("\n")[0])
    parser.add_argument("-n", type=int, default=2000)
    parser.add_argument("--seed", type=int, default=1)
    args = parser.parse_args()
    texts = examples()
    lines = texts["run.csv"].splitlines()
    head = "\n".join(line.lstrip("# ") for line in lines if line.startswith("#"))
    rows = "\n".join(line for line in lines if not line.startswith("#")) + "\n"
    counts: Counter[str] = Counter()
    with tempfile.TemporaryDirectory() as folder:
        place = Path(folder)
        for name, text in texts.items():
            (place / name).write_text(text, encoding="utf-8")
        chain = read_machine(place / "machine.toml")
        readers: dict[str, Callable[[Path], object]] = {
            "machine.toml": read_machine,
            "project.toml": read_project,
            "errors.toml": lambda path: read_errors(path, chain),
            "task.toml": read_task,
            "run.csv": read_run,
        }
        for k in range(args.n):
            rng = np.random.default_rng([args.seed, k])
            name = sorted(readers)[k % len(readers)]
            data = tomllib.loads(head if name == "run.csv" else texts[name])
            wrong = damaged(rng, data)
            path = place / f"wrong-{name}"
            text = run_text(wrong, rows) if name == "run.csv" else toml(wrong)
            path.write_text(text, encoding="utf-8")
            counts[outcome(readers[name], path, k)] += 1
    print(", ".join(f"{n} {what}" for what, n in sorted(counts.items())))
    return 0 if set(counts) <= {"read", "refused"} else 1


def outcome(read: Callable[[Path], object], path: Path, number: int) -> str:
    """What happens to one file."""
    try:
        read(path)
    except DesignError as error:
        text = str(error).replace(str(path), "FILE")
        is_foreign = FOREIGN.search(text)
        if is_foreign or "\n" in text or len(text) > 900:
            print(f"  {number}: {text[:400]}")
            return "refused in foreign words" if is_foreign else "refused at length"
        return "refused"
    except Exception as error:
        last = traceback.extract_tb(error.__traceback__)[-1]
        print(f"  {number}: {type(error).__name__} at {last.filename}:{last.lineno}: {error}"[:300])
        return "traceback"
    return "read"


if __name__ == "__main__":
    sys.exit(main())
