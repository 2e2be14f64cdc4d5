"""Inner parameters beyond the grid: a finer and finer scan around the best point.

A time constant or a period enters a signature non-linearly, and the search sees it only at points
of a grid. From the best point the evidence is scanned over one distance of the grid to either side,
then four times finer around the best of that, and so on: the evidence has several maxima within a
distance of the grid for a period, which a step along its slope would miss. Several inner parameters
are scanned in turn until the evidence stays; several effects in the same way, each with the
others in place.
"""

from collections.abc import Sequence

import numpy as np

from matstd.diagnosis.evidence import EffectSet, ResidualSpace, ScaledEffect, addition, projected
from matstd.diagnosis.fit import continuous_inner, spacing
from matstd.twin.frames import Array
from matstd.twin.model import Effect, is_tunable, with_inner

SCAN_POINTS = 9  # points of every scan, over one distance of the grid to either side

MAX_SCANS = 10
"""Most scans, each four times finer than the one before: an effect of a thousand times the noise
shows an inner parameter to a part in some ten thousand of the distance of its grid."""

MIN_SCANS = 3
"""Scans that are made in any case: between the points of the first there may be nothing better."""

MAX_SWEEPS = 6
"""Most turns through the inner parameters of an effect that has several: the best value of one
depends on the others."""

SETTLED_GAIN = 0.01  # gain of log evidence in one turn below which they are settled


def refined(base: EffectSet, effect: Effect, levels: int = MAX_SCANS) -> tuple[ScaledEffect, float]:
    """An effect with its inner parameters refined, and the log evidence of the set with it."""
    best, (top, scale) = effect, addition(base, effect)
    several = len(continuous_inner(effect, base.complement.touches)) > 1
    for _ in range(MAX_SWEEPS if several else 1):
        before = top
        best, top, scale = _sweep(base, best, top, scale, levels)
        if top - before < SETTLED_GAIN:
            break
    return ScaledEffect(best, scale), top


def _sweep(
    base: EffectSet, best: Effect, top: float, scale: float, levels: int
) -> tuple[Effect, float, float]:
    """Every inner parameter in turn; the effect with its log evidence and its size."""
    for index, inner, _ in continuous_inner(best, base.complement.touches):
        assert is_tunable(best)
        low, high = float(np.min(inner.grid)), float(np.max(inner.grid))
        for level in range(levels):
            before, value = top, list(best.tuning.values())[index]
            half = spacing(inner, value) / 4.0**level
            for point in np.clip(np.linspace(value - half, value + half, SCAN_POINTS), low, high):
                trial = with_inner(best, index, float(point))
                found, size = addition(base, trial)
                if found > top:
                    best, top, scale = trial, found, size
            if level >= MIN_SCANS and top - before < SETTLED_GAIN:
                break
    return best, top, scale


def refined_set(
    complement: ResidualSpace,
    chosen: Sequence[ScaledEffect],
    rounds: int = 2,
    fixed: Array | None = None,
) -> list[ScaledEffect]:
    """Effects of a set with all inner parameters refined, in turn, the others in place.

    Args:
        fixed: Further columns beside them.
    """
    out = list(chosen)
    beside = [] if fixed is None else [fixed]
    for _ in range(rounds if len(out) > 1 else 1):
        for i in range(len(out)):
            others = projected(complement, out[:i] + out[i + 1 :])
            out[i] = refined(EffectSet(complement, np.hstack([*beside, others])), out[i].effect)[0]
    return out
