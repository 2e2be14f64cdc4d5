"""Mistakes of a whole log, undone one at a time: another unit, an axis the other way."""

from collections.abc import Callable, Iterator, Sequence
from dataclasses import replace

import numpy as np

from matstd.probe_paths.control import LogPart
from matstd.probe_paths.plan import LINEAR
from matstd.twin.frames import Array
from matstd.twin.units import LENGTHS

LEAST_NEAR = 0.9  # share of the touches that meet their features once a mistake is undone


def log_slip(
    parts: Sequence[LogPart], gaps: Callable[[Sequence[LogPart]], Array], limit: float
) -> str:
    """The mistake without which nearly all touches meet their features; "" for none.

    Args:
        gaps: Distances between the balls of some parts and their features, (N,), mm; nan where a
            ball is so far off that there is none.
        limit: Largest of a touch that met its feature, mm.
    """
    for words, undone in _undone(parts):
        if float(np.mean(np.abs(gaps(undone)) < limit)) >= LEAST_NEAR:
            return words
    return ""


def _undone(parts: Sequence[LogPart]) -> Iterator[tuple[str, list[LogPart]]]:
    """Every mistake in words, and the parts without it."""
    for unit, size in LENGTHS:
        words = f"the readings of X, Y and Z are in {unit}"
        yield words, [replace(part, xyz=size * part.xyz) for part in parts]
    other_way = "{} moves in the direction opposite to that in the machine file"
    for i, letter in enumerate(LINEAR):
        sign = np.where(np.arange(len(LINEAR)) == i, -1.0, 1.0)
        yield other_way.format(letter), [replace(part, xyz=sign * part.xyz) for part in parts]
    for letter in parts[0].rotary:
        turned = [{**part.rotary, letter: -part.rotary[letter]} for part in parts]
        undone = [replace(p, rotary=own) for p, own in zip(parts, turned, strict=True)]
        yield other_way.format(letter), undone
