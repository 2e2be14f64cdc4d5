"""Keys of users' files: what each of them holds, and refusals in the words of the file.

A key states its type, range and default in its model, and what it is in the docstring below it.
Refusals, the tables of docs/formats and the comments of new files are made from these.
"""

import ast
import inspect
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from datetime import date, datetime
from enum import Enum
from functools import cache
from pathlib import Path
from textwrap import dedent
from types import UnionType
from typing import (
    Annotated,
    Any,
    Literal,
    NamedTuple,
    TypeGuard,
    TypeVar,
    Union,
    get_args,
    get_origin,
)

from pydantic import BaseModel, ConfigDict, ValidationError
from pydantic.fields import FieldInfo
from pydantic_core import PydanticUndefined

from matstd.twin.errors import BadFile
from matstd.twin.text import toml_value
from matstd.twin.words import did_you_mean, listed, nearest

UNITS = {
    "_mm_min": "mm/min",
    "_deg_min": "degrees/min",
    "_kg_m3": "kg/m³",
    "_1_K": "1/K",
    "_MPa": "MPa",
    "_mm": "mm",
    "_deg": "degrees",
    "_um": "µm",
    "_urad": "µrad",
    "_kg": "kg",
    "_degC": "°C",
    "_u_K": "K",
    "_s": "s",
    "pitch": "mm",
    "expected": "mm",
}
"""Units by the end of a key; the longer ends stand before those that they contain. Lengths of
machine files have none in their names."""

LONG = 90  # characters of a clause from which on what stands in brackets is left out of a refusal
T = TypeVar("T", bound=BaseModel)


class Table(BaseModel):
    """A table of a user's file: unknown keys, NaN, infinity and numbers in quotes are refused."""

    model_config = ConfigDict(
        extra="forbid", allow_inf_nan=False, strict=True, frozen=True, populate_by_name=True
    )

    @classmethod
    def keys(cls) -> "dict[str, Key]":
        """Its keys in their order, by their names in the file."""
        return keys_of(cls)


Fault = Callable[[Sequence[str], str, str], BadFile]
"""Makes a fault of the steps to a key, what stood there and what was expected."""


@dataclass(frozen=True)
class Key:
    """What one key of a table holds."""

    about: str  # description; "" where the model has none
    holds: str  # kind of value with its range and unit: `a whole number from 100 to 2000`
    range: str  # limits and unit of a number: `from 1 to 25 mm`; "" for neither
    example: str  # a valid value as it stands in a file; "" where there is none

    @property
    def short(self) -> str:
        """The first clause of the description, without marks of a page."""
        clause = self.about.partition(". ")[0].partition("; ")[0].rstrip(".").replace("`", "")
        return clause.partition(" (")[0] if len(clause) > LONG else clause

    @property
    def expected(self) -> str:
        """What should stand there, for a refusal."""
        such = f", such as {self.example}" if self.example else ""
        about = f" ({self.short})" if self.about else ""
        return self.holds + such + about


def keys_of(model: type[BaseModel]) -> dict[str, Key]:
    """The keys of a table in their order, by their names in the file."""
    about = _docstrings(model)
    out = {}
    for name, field in model.model_fields.items():
        key = field.alias or name
        holds = _holds(field.annotation, field.metadata, unit_of(key)).one
        bounds = _bounds(field.metadata, unit_of(key))
        out[key] = Key(about.get(name, field.description or ""), holds, bounds, _example(field))
    return out


@cache
def _docstrings(model: type[BaseModel]) -> dict[str, str]:
    """Docstrings below the fields of a model and of those that it extends, by name.

    They are read from the source when a refusal or a page needs them: commands do not wait for it.
    """
    out: dict[str, str] = {}
    for part in reversed(model.__mro__):
        if not issubclass(part, BaseModel) or part.__module__.startswith("pydantic"):
            continue
        body = ast.parse(dedent(inspect.getsource(part))).body[0]
        assert isinstance(body, ast.ClassDef)
        for field, text in zip(body.body, body.body[1:], strict=False):
            if isinstance(field, ast.AnnAssign) and isinstance(text, ast.Expr):
                out[ast.unparse(field.target)] = str(ast.literal_eval(text.value))
    return {name: " ".join(text.split()) for name, text in out.items()}


def unit_of(key: str) -> str:
    """Unit that the name of a key states, "" for none."""
    return next((unit for end, unit in UNITS.items() if key.endswith(end)), "")


def _example(field: FieldInfo) -> str:
    """A value as it stands in a file: an example of the model, or the default."""
    default = field.default
    if field.examples:
        return toml_value(field.examples[0])
    is_shown = default not in (PydanticUndefined, None, "", float("inf"))
    return toml_value(default) if is_shown and not isinstance(default, BaseModel | dict) else ""


class _Kind(NamedTuple):
    """Words for one value of a kind, and for several."""

    one: str
    several: str


_PLAIN = {
    date: _Kind("a date without quotes, such as 2031-05-06", "dates"),
    datetime: _Kind(
        "a date with its time, without quotes, 2031-05-06T07:08:09", "dates with their times"
    ),
    bool: _Kind("true or false", "true or false"),
    str: _Kind("text in quotes", "texts in quotes"),
}


def _holds(kind: Any, limits: Sequence[Any] = (), unit: str = "") -> _Kind:
    """Description of the values of an annotation."""
    origin, args = get_origin(kind), get_args(kind)
    if origin is Annotated:
        inner = [m for a in args[1:] for m in (a.metadata if isinstance(a, FieldInfo) else [a])]
        return _holds(args[0], [*limits, *inner], unit)
    if kind in (int, float):
        number = "whole number" if kind is int else "number"
        bounds = _bounds(limits, unit)
        comma = ", " if bounds[:1].isdigit() else " " if bounds else ""
        return _Kind(f"a {number}{comma}{bounds}", f"{number}s{comma}{bounds}")
    if kind in _PLAIN:
        return _PLAIN[kind]
    if origin is Literal or (isinstance(kind, type) and issubclass(kind, Enum)):
        words = listed([toml_value(value) for value in args or list(kind)], "or")
        return _Kind(words, words)
    if origin in (Union, UnionType):
        inner_kinds = [_holds(a, limits, unit) for a in args if a is not type(None)]
        return _Kind(
            listed([k.one for k in inner_kinds], "or"),
            listed([k.several for k in inner_kinds], "or"),
        )
    return _collection(kind, limits, unit)


def _collection(kind: Any, limits: Sequence[Any], unit: str) -> _Kind:
    """Description of lists and tables."""
    origin, args = get_origin(kind), get_args(kind)
    if origin in (tuple, list):
        count: object = len(args) if origin is tuple and Ellipsis not in args else ""
        count = next((m.min_length for m in limits if hasattr(m, "min_length")), count)
        items = f"{count} {_holds(args[0], (), unit).several}".strip()
        if _has_tables(kind):
            return _Kind(f"{items}, each under its own name in double brackets", items)
        return _Kind(f"{items} in brackets", f"lists of {items}")
    if origin is dict:
        inside = _holds(args[1], (), unit).several if args[1] not in (object, Any) else "values"
        return _Kind(f"a table of {inside} by name", "tables")
    if _is_table(kind):
        names = ", ".join(field.alias or name for name, field in kind.model_fields.items())
        return _Kind(f"a table with the keys {names}", f"tables with the keys {names}")
    return _Kind("a value", "values")


def _bounds(limits: Sequence[Any], unit: str = "") -> str:
    """Limits of a number with its unit: "from 100 to 2000", "1 mm or more"; "" for neither."""
    stated = {
        name: f"{value:.10g}{' ' + unit if unit else ''}"
        for limit in limits
        for name in ("ge", "gt", "le", "lt")
        if (value := getattr(limit, name, None)) is not None
    }
    low, high = stated.get("ge"), stated.get("le")
    if low and high:
        bare = low.removesuffix(f" {unit}")
        return f"within ±{high}" if low == f"-{high}" else f"from {bare} to {high}"
    words = {"ge": "{} or more", "gt": "above {}", "le": "up to {}", "lt": "below {}"}
    said = [text.format(stated[name]) for name, text in words.items() if name in stated]
    return ", ".join(said) or (f"in {unit}" if unit else "")


def checked(model: type[T], data: object, path: str | Path, within: str = "") -> T:
    """A table checked against its model; raises BadFile with all of its faults.

    The data stood under the key `within` of the file, or were all of it.
    """
    try:
        return model.model_validate(data)
    except ValidationError as error:
        found = error.errors(include_url=False)
    raise BadFile.several(list(_faults(found, model, data, path, within)))


def _faults(
    found: Sequence[Any], model: type[BaseModel], data: object, path: str | Path, within: str
) -> Iterator[BadFile]:
    """Every fault of a table once: unknown keys, wrong values, then missing keys."""

    def bad(steps: Sequence[str], what: str, expected: str) -> BadFile:
        where = ".".join(([within] if within else []) + list(steps)) or "file"
        return BadFile(path, where, what, expected)

    meant: list[str] = []  # by keys that are written wrongly: those are not missing as well
    missing: dict[tuple[str, ...], list[str]] = {}
    seen: set[tuple[str, ...]] = set()
    for error in sorted(found, key=lambda e: e["type"] != "extra_forbidden"):
        steps = [str(step) for step in error["loc"]]
        if error["type"] == "extra_forbidden":
            inside = _table(model, steps[:-1])
            known = list(keys_of(inside)) if inside else []
            meant.append(nearest(steps[-1], known))
            expected = f"one of {', '.join(known)}" if known else "a key of the format"
            yield bad(steps, f"an unknown key{did_you_mean(steps[-1], known)}", expected)
        elif error["type"] == "missing" and not steps[-1].isdigit():
            missing.setdefault(tuple(steps[:-1]), []).append(steps[-1])
        else:
            at, key = _whole(model, steps)
            if tuple(at) not in seen:
                seen.add(tuple(at))
                expected = key.expected if key else _whole_table(model, within)
                yield bad(at, _shown(data, at), expected)
    for place, names in missing.items():
        yield from _lacking(place, [name for name in names if name not in meant], model, bad)


def _whole_table(model: type[BaseModel], name: str) -> str:
    """What is expected where something else stands in place of a table."""
    needed = [f for f in model.model_fields if model.model_fields[f].is_required()]
    keys = keys_of(model)
    lines = [f"{key} = {keys[key].example}" for key in needed if keys[key].example]
    such = f", such as [{name}] and then {', '.join(lines)}" if name and lines else ""
    return _holds(model).one + such


def _lacking(
    place: Sequence[str], names: Sequence[str], model: type[BaseModel], bad: Fault
) -> Iterator[BadFile]:
    """The fault of a table without some of its keys."""
    inside = _table(model, place)
    if len(names) == 1 and inside:
        yield bad([*place, names[0]], "nothing", keys_of(inside)[names[0]].expected)
    elif names:
        yield bad(place, "nothing for several keys", f"the keys {', '.join(names)}")


def _shown(data: Any, steps: Sequence[str]) -> str:
    """What stood at a key."""
    try:
        for step in steps:
            data = data[int(step) if isinstance(data, list) else step]
        return toml_value(data)[:1000] if isinstance(data, bool) else repr(data)
    except (RecursionError, ValueError):  # lists without end, a number of thousands of digits
        return f"a {type(data).__name__} too large to show"


def _whole(model: type[BaseModel], steps: Sequence[str]) -> tuple[list[str], Key | None]:
    """The key that holds a faulty value, of which the fault may be a part, and its description."""
    kind: Any = model
    at: list[str] = []
    key: Key | None = None
    for step in steps:
        kinds = _bare(kind)
        kind = kinds[0] if len(kinds) == 1 else None
        if _is_table(kind):
            if step not in keys_of(kind):
                break
            key, kind = keys_of(kind)[step], _annotations(kind)[step]
        elif get_origin(kind) is dict or (get_origin(kind) is list and _has_tables(kind)):
            kind = get_args(kind)[-1]
            words = _holds(kind).one
            key = Key(key.about if key else "", words, "", "")
        else:
            break
        at.append(step)
    return at, key


def _bare(kind: Any) -> list[Any]:
    """Every alternative of an annotation, None apart, without what is annotated."""
    if get_origin(kind) is Annotated:
        return _bare(get_args(kind)[0])
    if get_origin(kind) in (Union, UnionType):
        return [bare for inner in get_args(kind) for bare in _bare(inner)]
    return [] if kind is type(None) else [kind]


def _has_tables(kind: Any) -> bool:
    """Whether the items of a list are tables, so that a fault has a key of its own."""
    return any(map(_is_table, _bare(get_args(kind)[0])))


def _is_table(kind: Any) -> TypeGuard[type[BaseModel]]:
    return isinstance(kind, type) and issubclass(kind, BaseModel)


def _annotations(model: type[BaseModel]) -> dict[str, Any]:
    return {field.alias or name: field.annotation for name, field in model.model_fields.items()}


def _table(model: type[BaseModel], steps: Sequence[str]) -> type[BaseModel] | None:
    """The table within a table to which some steps lead, None for anything else."""
    kind: Any = model
    for step in steps:
        first = _bare(kind)[0]
        tables = _annotations(first) if _is_table(first) else {}
        kind = tables.get(step) if tables else next(reversed(get_args(first)), None)
    last = next(iter(_bare(kind)), None)
    return last if _is_table(last) else None
