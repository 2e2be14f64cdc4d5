"""Records of arrays with an entry a row: some of their rows, or several records as one."""

from collections.abc import Mapping, Sequence
from dataclasses import Field, fields, replace
from typing import Any, ClassVar, Protocol, TypeVar

import numpy as np

from matstd.twin.frames import IntArray, Mask


class _IsRecord(Protocol):
    """What every dataclass has."""

    __dataclass_fields__: ClassVar[dict[str, Field[Any]]]


Record = TypeVar("Record", bound=_IsRecord)


def picked(record: Record, rows: Mask | IntArray | slice) -> Record:
    """The record with those of its rows; every array of it, alone or in a mapping, has them."""
    found: dict[str, Any] = {}
    for field in fields(record):
        value = getattr(record, field.name)
        if isinstance(value, np.ndarray):
            found[field.name] = value[rows]
        elif isinstance(value, Mapping):
            found[field.name] = {name: of[rows] for name, of in value.items()}
    return replace(record, **found)


def stacked(records: Sequence[Record]) -> Record:
    """The rows of all records one after the other; other fields are those of the first."""
    names = [
        f.name for f in fields(records[0]) if isinstance(getattr(records[0], f.name), np.ndarray)
    ]
    return replace(
        records[0], **{n: np.concatenate([getattr(r, n) for r in records]) for n in names}
    )
