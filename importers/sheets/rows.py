"""Records whose arrays all have a row for every reading: some of their rows, several as one."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import fields, replace
from typing import TYPE_CHECKING, Any, TypeVar

import numpy as np

if TYPE_CHECKING:
    from _typeshed import DataclassInstance

    Record = TypeVar("Record", bound=DataclassInstance)


def picked(record: Record, rows: np.ndarray) -> Record:
    """The record with those of its rows, by a mask or by their indices."""
    found: dict[str, Any] = {}
    for field in fields(record):
        value = getattr(record, field.name)
        if isinstance(value, np.ndarray):
            found[field.name] = value[rows]
        elif isinstance(value, Mapping):
            found[field.name] = {name: of[rows] for name, of in value.items()}
    return replace(record, **found)


def stacked(records: Sequence[Record]) -> Record:
    """The rows of all records one after the other; what is no array is that of the first."""
    names = [
        f.name for f in fields(records[0]) if isinstance(getattr(records[0], f.name), np.ndarray)
    ]
    return replace(
        records[0], **{n: np.concatenate([getattr(r, n) for r in records]) for n in names}
    )
