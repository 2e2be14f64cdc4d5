"""What is left out together, so that what predicts it has not seen it, and what that shows."""

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from matstd.diagnosis.evidence import EffectSet, ResidualSpace, ScaledEffect, projected
from matstd.diagnosis.fit import MIN_POSES, Fit
from matstd.diagnosis.regression import Memory
from matstd.twin.model import traits
from matstd.twin.numbers import rms
from matstd.twin.record import IntArray

MAX_BLOCKS = 6
"""Blocks of a choice by prediction: each is one more search."""

MEMORY_LENGTHS = 3.0
"""Times that a block is longer than the memory of the residual: 5 % are left at its middle."""


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


def prune_by_held_out_error(
    complement: ResidualSpace, effects: Sequence[ScaledEffect], groups: Sequence[IntArray]
) -> tuple[ScaledEffect, ...]:
    """The set without effects that do not lower the error of left-out blocks, the worst first.

    Args:
        effects: The set, at inner parameters found with all rows in use.
        groups: Rows of the run in every block; those not in use are passed over.
    """
    place = np.full(len(complement.used), -1)
    place[complement.used] = np.arange(int(complement.used.sum()))
    inside = tuple(g for g in (place[rows][place[rows] >= 0] for rows in groups) if len(g))
    by_block = replace(complement, groups=inside)
    out = list(effects)
    error = _error(by_block, out)
    while out:
        without = [_error(by_block, out[:i] + out[i + 1 :]) for i in range(len(out))]
        i = int(np.argmin(without))
        if without[i] > error:
            break
        error = without[i]
        out.pop(i)
    return _renumbered(out)


def _error(complement: ResidualSpace, effects: Sequence[ScaledEffect]) -> float:
    """Plain root mean square error of blocks left out, mm."""
    left = EffectSet(complement, projected(complement, effects)).held_out
    return rms(left.error * complement.u)


def _renumbered(effects: Sequence[ScaledEffect]) -> tuple[ScaledEffect, ...]:
    """The effects renumbered so that no second one exists without a first."""
    names = {s.effect.name for s in effects}
    out = []
    for sized in effects:
        own = traits(sized.effect)
        if own.repetition > 1 and own.original is not None and own.original.name not in names:
            sized = replace(sized, effect=own.original)
        out.append(sized)
    return tuple(out)
