"""A set without effects that predict nothing of blocks that are left out."""

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from matstd.diagnosis.evidence import EffectSet, ResidualSpace, ScaledEffect, projected
from matstd.twin.model import traits
from matstd.twin.numbers import rms
from matstd.twin.record import IntArray


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
