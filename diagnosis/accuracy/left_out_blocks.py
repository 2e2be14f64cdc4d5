"""What is left out together, so that what predicts it has not seen it.

A pose that is left out has neighbours that were touched with the same sensors at nearly the same
temperatures; so a law and a promise are judged by `domains`, the halves of what was probed, and a
choice, which is made anew without every block, by a few blocks that follow how the data came.
"""

from collections.abc import Iterator

import numpy as np

from matstd.diagnosis.fit import MIN_POSES, Fit
from matstd.diagnosis.regression import Memory
from matstd.twin.frames import Array, IntArray, Mask
from matstd.twin.record import Touches

PARTS_OF_TIME = 5
"""Stretches of time that are left out in turn; a law of warming up is seen in one of them."""

MIN_ROWS = 4  # touches that a block must leave out to be a test
MAX_BLOCKS = 6  # blocks of a choice by prediction: each is one more search

MEMORY_LENGTHS = 3.0
"""Times that a block is longer than the memory of the residual: 5 % are left at its middle."""


def domains(touches: Touches, used: Mask) -> dict[str, tuple[IntArray, ...]]:
    """Blocks of every domain that has several, by its column; `time_s`, `setup`, `force`.

    Halves of the readings of every axis and of the load, stretches of time, set-ups; rows by their
    numbers within those used.
    """
    inside = {name: b for name, b in _all_domains(touches, used) if len(b) > 1}
    return {name: b for name, b in inside.items() if min(map(len, b)) >= MIN_ROWS}


def _all_domains(touches: Touches, used: Mask) -> Iterator[tuple[str, tuple[IntArray, ...]]]:
    for axis in touches.chain.programmed_axes:
        yield touches.chain.link(axis).column, _each(_is_upper(touches.reading(axis)[used]))
    order = np.argsort(touches.time[used], kind="stable")
    yield "time_s", tuple(np.array_split(order, PARTS_OF_TIME))
    yield "setup", _each(touches.setup[used])
    if touches.force is not None:
        yield "force", _each(_is_upper(np.linalg.norm(touches.force, axis=1)[used]))


def _is_upper(values: Array) -> Mask:
    return np.asarray(values > np.median(values))


def _each(label: Mask | IntArray) -> tuple[IntArray, ...]:
    return tuple(np.flatnonzero(label == one) for one in np.unique(label))


def blocks(fit: Fit, memory: Memory | None) -> tuple[IntArray, ...]:
    """Rows of a run that are left out together.

    Runs, where there are enough of them: the next one is what shall be predicted. Else poses of a
    set-up, or whatever the run calls a pose (a cycle, a day), several together where there are
    many; stretches of time where they are fewer than `MIN_POSES` or shorter than the residual
    remembers.

    Args:
        memory: Of what it leaves; None for none.
    """
    t = fit.run.touches
    rows = np.flatnonzero(fit.used)
    order = np.argsort(t.time[rows], kind="stable")
    by_run = len(np.unique(t.run[rows])) >= MIN_POSES
    key = (t.run[:, None] if by_run else np.column_stack([t.setup, t.pose]))[rows]
    label = np.unique(key, axis=0, return_inverse=True)[1].reshape(-1)
    count = int(label.max()) + 1
    middle = [float(np.median(t.time[rows][label == k])) for k in range(count)]
    label = np.argsort(np.argsort(middle, kind="stable"))[label]  # numbered as they came
    remembered = _touches(fit, memory)
    if count >= MIN_POSES and len(rows) / count >= MEMORY_LENGTHS * remembered:
        merged = label * min(count, MAX_BLOCKS) // count
        return tuple(rows[merged == k] for k in range(int(merged.max()) + 1))
    several = int(np.clip(len(rows) / max(MEMORY_LENGTHS * remembered, 1.0), MIN_POSES, MAX_BLOCKS))
    return tuple(np.sort(rows[part]) for part in np.array_split(order, several))


def _touches(fit: Fit, memory: Memory | None) -> float:
    """Rows of the fit over which a residual is remembered."""
    if memory is None:
        return 0.0
    if memory.time is not None:
        span = float(np.ptp(fit.run.touches.time[fit.used]))
        return memory.time / max(span, 1e-9) * int(fit.used.sum())
    places = 1
    if memory.by_place:
        t = fit.run.touches
        places = len(np.unique(np.column_stack([t.point, t.normal])[fit.used], axis=0))
    return memory.length * places
