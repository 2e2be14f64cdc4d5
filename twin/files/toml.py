"""TOML files of users: every fault is reported in one line."""

import math
import re
import tomllib
from collections.abc import Iterator, Sequence
from pathlib import Path
from types import SimpleNamespace
from typing import Any, TypeVar, get_args, get_origin

from pydantic import BaseModel, ConfigDict, ValidationError
from pydantic.fields import FieldInfo

from matstd.twin.errors import BadFile
from matstd.twin.words import did_you_mean

_NO_TEXT = {
    b"PK\x03\x04": "a zip archive, such as a workbook of Excel (save it as CSV)",
    b"\x89PNG": "a picture",
    b"%PDF": "a PDF",
    b"\xff\xfe": "text in UTF-16",
    b"\xfe\xff": "text in UTF-16",
}
"""First bytes of files that users take for text, and what they are."""

LARGEST = 1e18
"""Largest number in our files; the product of two such does not overflow."""

_MANY_DIGITS = re.compile(r"[\d_]{4300,}")
_TWICE = re.compile(r"Cannot declare \((.+?),?\) twice")

_DECIMAL_COMMA = re.compile(r"=\s*-?\d+,\d+\s*$")


class Table(BaseModel):
    """A table of a user's file: unknown keys, NaN, infinity and numbers in quotes are refused."""

    model_config = ConfigDict(
        extra="forbid", allow_inf_nan=False, strict=True, frozen=True, populate_by_name=True
    )


T = TypeVar("T", bound=BaseModel)


def _bytes(path: str | Path) -> bytes:
    """What a user's file holds; raises BadFile if it cannot be read."""
    try:
        return Path(path).read_bytes()
    except (OSError, ValueError) as error:  # ValueError: a name with a zero byte
        found = getattr(error, "strerror", None) or str(error)
        raise BadFile(path, "file", found, "a file that can be read") from error


def read_text(path: str | Path) -> str:
    """Text of a user's file; raises BadFile if it is missing or not UTF-8."""
    data = _bytes(path)
    for begin, what in _NO_TEXT.items():
        if data.startswith(begin):
            raise BadFile(path, "file", what, "a text file (UTF-8)")
    try:
        return _one_line_end(data.decode("utf-8-sig"))
    except UnicodeDecodeError as error:
        line = data.count(b"\n", 0, error.start) + 1
        if b"\0" in data:
            raise BadFile(path, "file", "no text", "a text file (UTF-8)") from error
        found = f"byte {data[error.start]:#04x}, which is no UTF-8"
        raise BadFile(path, f"line {line}", found, "text saved as UTF-8") from error


def read_any_text(path: str | Path) -> str:
    """Text as spreadsheets and instruments save it: UTF-8, UTF-16, else Windows-1252.

    Raises:
        BadFile: The file cannot be read, or holds no text.
    """
    data = _bytes(path)
    if data.startswith((b"\xff\xfe", b"\xfe\xff")):
        return _one_line_end(data.decode("utf-16", errors="replace"))
    try:
        data.decode("utf-8")
    except UnicodeDecodeError:
        if b"\0" not in data:
            return _one_line_end(data.decode("cp1252", errors="replace"))
    return read_text(path)


def is_file(path: Path) -> bool:
    """Whether there is such a file; a name that the system cannot take has none."""
    try:
        return path.is_file()
    except OSError:
        return False


def _one_line_end(text: str) -> str:
    """Text with line feeds, whichever system wrote it."""
    return text.replace("\r\n", "\n").replace("\r", "\n") if "\r" in text else text


def parse_toml(
    text: str, path: str | Path, first_line: int = 1, twice: str = "it once"
) -> dict[str, Any]:
    """Tables of a TOML text; raises BadFile.

    Args:
        first_line: Line number of the text in the file.
        twice: What is expected of a table that stands in two places; `{name}` is its name.
    """
    try:
        return tomllib.loads(text, parse_float=_moderate)
    except tomllib.TOMLDecodeError as error:
        raise _no_toml(error, text, path, first_line, twice) from error
    except RecursionError:
        raise BadFile(path, "file", "brackets nested without end", "a valid TOML file") from None
    except ValueError as error:  # Python converts no whole number of more than 4300 digits
        long = _MANY_DIGITS.search(text)
        literal = long.group() if long else str(error)
        line = first_line + text.count("\n", 0, max(text.find(literal), 0))
        expected = "a number of fewer digits" if long else f"numbers below {LARGEST:g}"
        raise BadFile(path, f"line {line}", literal, expected) from None


def _moderate(literal: str) -> float:
    """A number that may be squared without overflow; NaN and infinity are for the models."""
    value = float(literal)
    if LARGEST < abs(value) < math.inf:
        raise ValueError(literal)
    return value


def _no_toml(
    error: tomllib.TOMLDecodeError, text: str, path: str | Path, first_line: int, twice: str
) -> BadFile:
    """The line that is no TOML, and why."""
    why, _, place = str(error).partition(" (at ")
    match = re.match(r"line (\d+)", place)
    lines = text.splitlines()
    number = int(match.group(1)) if match else len(lines)
    line = lines[number - 1].strip() if 0 < number <= len(lines) else ""
    place = f"line {first_line + number - 1}"
    repeated = _TWICE.match(why)
    if repeated:
        name = re.sub(r"', '", ".", repeated.group(1)).strip("'")
        return BadFile(path, place, f"table [{name}] a second time", twice.format(name=name))
    comma = " and a point in decimal numbers" if _DECIMAL_COMMA.search(line) else ""
    expected = f"a whole, valid TOML file{comma} ({why[:1].lower()}{why[1:]})"
    found = repr(line[:60]) if line else "an end"
    return BadFile(path, place, found, expected)


def checked(model: type[T], data: object, path: str | Path, within: str = "") -> T:
    """A table checked against its model; raises BadFile with the first fault.

    Args:
        model: Pydantic model with the units in its field names.
        within: Key under which the data stood.
    """
    try:
        return model.model_validate(data)
    except ValidationError as error:
        raise _as_bad_file(error, model, path, within) from None


def _as_bad_file(
    error: ValidationError, model: type[BaseModel], path: str | Path, within: str
) -> BadFile:
    """First fault of a table in one line."""
    found = error.errors(include_url=False)
    # a key that is written wrongly is unknown, and the right one is missing: say the former
    first = next((e for e in found if e["type"] == "extra_forbidden"), found[0])
    steps = [str(step) for step in first["loc"] if not str(step).startswith("function-")]
    key = ".".join(([within] if within else []) + steps) or "file"
    if first["type"] == "extra_forbidden":
        known = list(_keys(model, steps[:-1]))
        expected = f"one of {', '.join(known)}" if known else "a key of the format"
        return BadFile(path, key, f"an unknown key{did_you_mean(steps[-1], known)}", expected)
    if first["type"] == "missing":
        lacking = [
            str(e["loc"][-1])
            for e in found
            if e["type"] == "missing" and e["loc"][:-1] == first["loc"][:-1]
        ]
        if steps[-1].isdigit() and (field := _field(model, steps[:-1])):
            whole = key.rpartition(".")[0]
            return BadFile(path, whole, repr(first["input"]), _list(field))
        if len(lacking) == 1:
            return BadFile(path, key, "nothing", "this key")
        table = ".".join(key.split(".")[:-1]) or "file"
        return BadFile(path, table, "nothing for several keys", f"the keys {', '.join(lacking)}")
    try:
        shown = repr(first["input"])
    except (RecursionError, ValueError):  # lists without end, a number of thousands of digits
        shown = f"a {type(first['input']).__name__} too large to show"
    return BadFile(path, key, shown, _expected(first, model, steps))


_KINDS = {
    "bool_type": "true or false",
    "string_type": "text in quotes",
    "dict_type": "a table",
    "list_type": "a list in brackets",
}


def _expected(error: Any, model: type[BaseModel], steps: list[str]) -> str:
    """The expected value in the words of the file, not of the library."""
    kind: str = error["type"]
    field = _field(model, steps)
    bounds = _bounds(field.metadata if field else [])
    is_whole = kind.startswith("int_") or (field is not None and field.annotation is int)
    number = "a whole number" if is_whole else "a number"
    if kind in ("int_type", "int_from_float", "float_type"):
        return f"{number}{bounds}"
    if kind.startswith(("greater_than", "less_than")):
        return f"{number}{bounds or _bounds([SimpleNamespace(**error['ctx'])])}"
    if kind == "model_type" and (known := list(_keys(model, steps))):
        return f"a table with the keys {', '.join(known)}"
    if kind in ("tuple_type", "too_long", "too_short") and field:
        return _list(field)
    message: str = error["msg"]
    return _KINDS.get(kind, message.removeprefix("Value error, ").removeprefix("Input should be "))


def _list(field: FieldInfo) -> str:
    """Description of the list that a field expects, with its length where that is fixed."""
    items = next(_items(field.annotation), (Ellipsis,))
    return "a list in brackets" if Ellipsis in items else f"a list of {len(items)} values"


def _items(kind: Any) -> Iterator[tuple[Any, ...]]:
    """The kinds of the items of every list inside an annotation, such as an optional one."""
    if get_origin(kind) is tuple:
        yield get_args(kind)
    else:
        for inner in get_args(kind):
            yield from _items(inner)


def _bounds(limits: Sequence[Any]) -> str:
    """Limits of a number: " from 100 to 2000", ", 1 or more", " above 0"; "" for none."""
    stated = {
        name: f"{value:.10g}"
        for limit in limits
        for name in ("ge", "gt", "le", "lt")
        if (value := getattr(limit, name, None)) is not None
    }
    if "ge" in stated and "le" in stated:
        return f" from {stated['ge']} to {stated['le']}"
    words = {"ge": ", {} or more", "gt": " above {}", "le": ", {} or less", "lt": " below {}"}
    return " and".join(words[name].format(value) for name, value in stated.items())


def _field(model: type[BaseModel], steps: list[str]) -> FieldInfo | None:
    """The field to which some steps lead; None for a part of a list or an unknown one."""
    inner = _table(model, steps[:-1])
    fields = inner.model_fields.items() if inner and steps else ()
    return next((field for name, field in fields if (field.alias or name) == steps[-1]), None)


def _keys(model: type[BaseModel], steps: list[str]) -> dict[str, Any]:
    """Keys, with their types, of the table within a table to which some steps lead."""
    inner = _table(model, steps)
    return _fields(inner) if inner else {}


def _table(model: type[BaseModel], steps: list[str]) -> type[BaseModel] | None:
    """The table within a table to which some steps lead, None for anything else."""
    kind: Any = model
    for step in steps:
        is_table = isinstance(kind, type) and issubclass(kind, BaseModel)
        kind = _fields(kind).get(step) if is_table else next(reversed(get_args(kind)), None)
    return kind if isinstance(kind, type) and issubclass(kind, BaseModel) else None


def _fields(model: type[BaseModel]) -> dict[str, Any]:
    return {field.alias or name: field.annotation for name, field in model.model_fields.items()}


def check_format(data: dict[str, Any], wanted: str, path: str | Path) -> None:
    """Raise BadFile unless `format` says what the reader understands."""
    if data.get("format") != wanted:
        found = repr(data["format"]) if "format" in data else "nothing"
        older = "; files of other versions are not read" if _is_version(data, wanted) else ""
        raise BadFile(path, "format", found, f'"{wanted}"{older}')


def _is_version(data: dict[str, Any], wanted: str) -> bool:
    """Whether a file is of the wanted kind in another version."""
    return str(data.get("format", "")).partition("/")[0] == wanted.partition("/")[0]
