"""Inner parameters beyond the grid: a finer and finer scan around the best point."""

from collections.abc import Sequence

import numpy as np

from diagnosis.candidates import Complement, projected
from diagnosis.evidence import EffectSet
from diagnosis.inner import continuous_inner, spacing
from twin.effect import Effect, Tunable
from twin.frames import Array

POINTS = 9
"""Points of every scan, over one distance of the grid to either side."""

LEVELS = 4
"""Scans, each four times finer than the one before."""


def refined(
    complement: Complement, effect: Effect, others: Array, levels: int = LEVELS
) -> tuple[Effect, float]:
    """An effect with its inner parameters refined, and the log evidence of the set with it.

    Args:
        complement: What the model leaves.
        effect: At the best point of its grid.
        others: Projected columns of what else is in the set, (N + P, K).
        levels: Number of scans.
    """
    best = effect
    top = _evidence(complement, others, effect)
    for index, inner, _ in continuous_inner(effect, complement.touches):
        assert isinstance(best, Tunable)
        low, high = float(np.min(inner.grid)), float(np.max(inner.grid))
        for level in range(levels):
            value = list(best.tuning.values())[index]
            half = spacing(inner, value) / 4.0**level
            for point in np.clip(np.linspace(value - half, value + half, POINTS), low, high):
                trial = _moved(best, index, float(point))
                found = _evidence(complement, others, trial)
                if found > top:
                    best, top = trial, found
    return best, top


def _moved(effect: Tunable, index: int, value: float) -> Tunable:
    values = list(effect.tuning.values())
    values[index] = value
    return effect.tuned(*values)


def _evidence(complement: Complement, others: Array, effect: Effect) -> float:
    A = np.hstack([others, projected(complement, [effect])])
    return EffectSet(complement, A).evidence


def refined_set(complement: Complement, effects: Sequence[Effect], rounds: int = 2) -> list[Effect]:
    """Effects of a set with all inner parameters refined, in turn, the others in place."""
    out = list(effects)
    for _ in range(rounds if len(out) > 1 else 1):
        for i in range(len(out)):
            rest = out[:i] + out[i + 1 :]
            others = (
                projected(complement, rest) if rest else np.zeros((len(complement.residual), 0))
            )
            out[i] = refined(complement, out[i], others)[0]
    return out
