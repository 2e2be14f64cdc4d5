"""Numbers of a file that are one slip of their unit away from what is usual.

Every key states its unit in its name, and a usual value as its default or its example. One rule
holds for all keys; a key without a usual value is asked about only where the numbers are whole in
another unit.
"""

from collections.abc import Iterator, Sequence
from pathlib import Path
from typing import Any

from pydantic import BaseModel
from pydantic.fields import FieldInfo

from matstd.twin.errors import BadFile
from matstd.twin.files.keys import unit_of
from matstd.twin.units import in_another_unit


def refuse_unit_slips(table: BaseModel, path: str | Path) -> None:
    """Refuse a file with numbers that were typed in another unit.

    Raises:
        BadFile: All of them, with what each was taken for.
    """
    if slips := list(_slips(table, path, "")):
        raise BadFile.several(slips)


def _slips(table: BaseModel, path: str | Path, within: str) -> Iterator[BadFile]:
    """Those of a table under a key."""
    for name, field in type(table).model_fields.items():
        if name in table.model_fields_set:
            key = field.alias or name
            where = f"{within}.{key}" if within else key
            yield from _slips_of(getattr(table, name), field, key, path, where)


def _slips_of(
    value: Any, field: FieldInfo, key: str, path: str | Path, where: str
) -> Iterator[BadFile]:
    """Of one value: numbers, or tables with keys of their own."""
    if isinstance(value, BaseModel):
        yield from _slips(value, path, where)
    elif isinstance(value, dict):
        for name, inner in value.items():
            yield from _slips_of(inner, field, key, path, f"{where}.{name}")
    elif isinstance(value, list) and all(isinstance(inner, BaseModel) for inner in value):
        for i, inner in enumerate(value):
            yield from _slips(inner, path, f"{where}.{i}")
    elif numbers := _numbers(value):
        unit, usual = unit_of(key), _usual(field)
        other = in_another_unit(numbers, unit, usual)
        if other is not None:
            name, size = other
            meant = f"{_listed([size * v for v in numbers])} {unit}"
            about = "" if usual is None else f", usually about {usual:g}"
            expected = f"{unit}{about}; is it in {name}, {meant}?"
            yield BadFile(path, where, _listed(numbers), expected)


def _numbers(value: Any) -> list[float]:
    """The numbers of a value; none of anything else, or of a table of numbers."""
    values = value if isinstance(value, tuple | list) else [value]
    is_number = [isinstance(v, int | float) and not isinstance(v, bool) for v in values]
    return list(values) if values and all(is_number) else []


def _usual(field: FieldInfo) -> float | None:
    """The usual value of a key, the largest of several: its default, or its example."""
    for said in (field.default, *(field.examples or ())):
        if (numbers := _numbers(said)) and 0.0 < max(numbers) < float("inf"):
            return max(numbers)
    return None


def _listed(values: Sequence[float]) -> str:
    """As in a file."""
    texts = [f"{v:.4g}" for v in values]
    return f"[{', '.join(texts)}]" if len(texts) > 1 else texts[0]
