"""Rows of records: selecting, stacking, and times by their order."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import fields, replace
from typing import TYPE_CHECKING, Any, TypeVar

import numpy as np

from matstd.twin.errors import DesignError
from matstd.twin.record import Run
from matstd.twin.units import DAY

if TYPE_CHECKING:
    from _typeshed import DataclassInstance

    Record = TypeVar("Record", bound=DataclassInstance)


def filled_lines(text: str) -> list[tuple[int, str]]:
    """Lines of a text that are not blank, stripped, with their numbers from 1."""
    return [(i, line.strip()) for i, line in enumerate(text.splitlines(), 1) if line.strip()]


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
    """The rows of all records one after the other; other fields are those of the first."""
    names = [
        f.name for f in fields(records[0]) if isinstance(getattr(records[0], f.name), np.ndarray)
    ]
    return replace(
        records[0], **{n: np.concatenate([getattr(r, n) for r in records]) for n in names}
    )


def timed_by_rows(run: Run, step: float) -> Run:
    """The run with times by the order of the rows of its table, `step` s apart.

    Readings of one row are one moment. Raises DesignError for a step out of range, or a run that
    has times.
    """
    if not 0.0 < step <= DAY:
        raise DesignError(f"--in-order {step:g}: expected seconds from 0 to {DAY:g}")
    touches = run.touches
    if np.ptp(touches.time) > 0.0:
        raise DesignError("--in-order: the table has times; expected one without")
    time = np.zeros(len(run))
    for k in np.unique(touches.run):
        rows = touches.run == k
        time[rows] = step * np.unique(run.line[rows], return_inverse=True)[1]
    return replace(run, touches=replace(touches, time=time))
