"""Waves that are whole fractions of one period, reported as one periodic error of that shape."""

from collections.abc import Iterator, Sequence

import numpy as np

from matstd.diagnosis.evidence import EffectSet, ResidualSpace, ScaledEffect, addition, projected
from matstd.diagnosis.policy import POLICY
from matstd.twin.effects import MAX_OVERTONES, usual_distance
from matstd.twin.model import Effect, Wave, original_of, traits

MAX_STRONGEST_ORDER = 4
"""The strongest wave of a period is at most its fourth."""


def with_overtones(
    complement: ResidualSpace, found: Sequence[ScaledEffect]
) -> tuple[ScaledEffect, ...] | None:
    """A set with waves over one axis exchanged for one period of several sines; None for none."""
    best: tuple[float, tuple[ScaledEffect, ...] | None] = (
        EffectSet(complement, projected(complement, found)).evidence + POLICY.log_evidence_gain,
        None,
    )
    for wave in found:
        own = _wave(wave.effect)
        for period in (
            () if own is None else [k * own.period for k in range(1, MAX_STRONGEST_ORDER + 1)]
        ):
            for comb in _combs(complement, wave.effect, period):
                rest = tuple(s for s in found if not _is_fraction(complement, s.effect, comb))
                beside = EffectSet(complement, projected(complement, rest))
                evidence, scale = addition(beside, comb)
                if evidence > best[0]:
                    best = evidence, (*rest, ScaledEffect(comb, scale))
    return best[1]


def _combs(complement: ResidualSpace, effect: Effect, period: float) -> Iterator[Effect]:
    """One period with two or more sines, up to the number that the readings resolve."""
    wave, with_sines = _wave(effect), traits(original_of(effect)).with_sines
    assert wave is not None
    assert with_sines is not None
    q = complement.touches.reading(wave.symbol.link)[complement.used]
    most = min(MAX_OVERTONES, int(period / (2.0 * usual_distance(q))))
    if period < 0.5 * float(np.ptp(q)):
        for order in range(2, most + 1):
            yield with_sines(period, order)


def _wave(effect: Effect) -> Wave | None:
    """The single sine that an effect is, for the second time or not."""
    wave = traits(original_of(effect)).wave
    return wave if wave is not None and wave.sines == 1 else None


def _is_fraction(complement: ResidualSpace, effect: Effect, sines: Effect) -> bool:
    """Whether an effect is one of the sines of a period, within the resolution of the travel."""
    wave, comb = _wave(effect), traits(sines).wave
    if wave is None or comb is None or wave.symbol != comb.symbol:
        return False
    k = round(comb.period / wave.period)
    q = complement.touches.reading(wave.symbol.link)[complement.used]
    apart = abs(1.0 / wave.period - k / comb.period) * float(np.ptp(q))
    return 1 <= k <= comb.sines and apart < 0.5
