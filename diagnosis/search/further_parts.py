"""Parts that only a finding asks for: one period of several sines, further periods, tables.

A library of every second period beside every first, and of a table of positions of every component
of every axis, would imitate anything. So they are offered when what was found, or what it leaves,
asks for them, and the set with them is searched from the beginning.
"""

from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass

import numpy as np

from matstd.diagnosis.evidence import (
    EffectSet,
    ResidualSpace,
    ScaledEffect,
    addition,
    period_of,
    projected,
)
from matstd.diagnosis.policy import POLICY
from matstd.twin.effects import MAX_OVERTONES, repeat, usual_distance
from matstd.twin.library import parse_effect
from matstd.twin.machine import LETTERS
from matstd.twin.model import Effect, Wave, original_of, traits
from matstd.twin.record import Touches

MAX_STRONGEST_ORDER = 4  # the strongest wave of a period is at most its fourth
MAX_PERIODS = 4  # most periods of one component error of one axis


@dataclass(frozen=True, slots=True, eq=False)
class WiderSearch:
    """A search with further candidates."""

    candidates: tuple[Effect, ...]  # all of them
    new: frozenset[str]  # names of those that are new, of which the set must have one
    start: tuple[ScaledEffect, ...] = ()  # a set to begin with
    share: float = 1.0  # held-out error with them, over that without, below which they are taken
    # whether only one of them may be taken, and only if nothing remains beside it
    is_alone: bool = False


def one_period(
    complement: ResidualSpace, found: Sequence[ScaledEffect], offered: Sequence[Effect]
) -> Iterator[WiderSearch]:
    """Waves over one axis that are whole fractions of one period, as one error of that shape."""
    best = EffectSet(complement, projected(complement, found)).evidence + POLICY.log_evidence_gain
    start: tuple[ScaledEffect, ...] = ()
    for wave in found:
        for comb in _combs(complement, wave.effect):
            rest = tuple(s for s in found if not _is_fraction(complement, s.effect, comb))
            beside = EffectSet(complement, projected(complement, rest))
            evidence, scale = addition(beside, comb)
            if evidence > best:
                best, start = evidence, (*rest, ScaledEffect(comb, scale))
    if start:
        gone = {s.effect.name for s in found} - {s.effect.name for s in start[:-1]}
        kept = (e for e in offered if e.name not in gone or traits(e).repetition == 1)
        comb = start[-1].effect
        yield WiderSearch((*kept, comb), frozenset([comb.name]), start)


def _combs(complement: ResidualSpace, effect: Effect) -> Iterator[Effect]:
    """Periods of which a wave is a sine, with two sines or more up to what the readings resolve."""
    wave, with_sines = _sine(effect), traits(original_of(effect)).with_sines
    if wave is None or with_sines is None:
        return
    q = complement.touches.reading(wave.symbol.link)[complement.used]
    for period in (k * wave.period for k in range(1, MAX_STRONGEST_ORDER + 1)):
        if period < 0.5 * float(np.ptp(q)):
            most = min(MAX_OVERTONES, int(period / (2.0 * usual_distance(q))))
            yield from (with_sines(period, order) for order in range(2, most + 1))


def _sine(effect: Effect) -> Wave | None:
    """The single sine that an effect is, for the second time or not."""
    wave = traits(original_of(effect)).wave
    return wave if wave is not None and wave.sines == 1 else None


def _is_fraction(complement: ResidualSpace, effect: Effect, sines: Effect) -> bool:
    """Whether an effect is one of the sines of a period, within the resolution of the travel."""
    wave, comb = _sine(effect), traits(sines).wave
    if wave is None or comb is None or wave.symbol != comb.symbol:
        return False
    k = round(comb.period / wave.period)
    q = complement.touches.reading(wave.symbol.link)[complement.used]
    apart = abs(1.0 / wave.period - k / comb.period) * float(np.ptp(q))
    return 1 <= k <= comb.sines and apart < 0.5


def further_periods(
    complement: ResidualSpace, found: Sequence[ScaledEffect], offered: Sequence[Effect]
) -> Iterator[WiderSearch]:
    """A further period of every error that repeats: a screw and its encoder have two."""
    known = {e.name for e in offered}
    new: list[Effect] = []
    for effect in (s.effect for s in found if traits(s.effect).repetition == 1):
        if period_of(effect, complement):
            copies = (repeat(effect, k) for k in range(2, MAX_PERIODS + 1))
            new += [c for c in copies if c is not None and c.name not in known][:1]
    if new:
        yield WiderSearch((*offered, *new), frozenset(e.name for e in new))


def tables_along(touches: Touches, variables: Iterable[str]) -> Iterator[Effect]:
    """Tables of every component of the axes that are among some variables, `X_mm` or `B_deg`."""
    for variable in dict.fromkeys(variables):
        axis, _, unit = variable.rpartition("_")
        if unit in ("mm", "deg") and axis in touches.chain.programmed_axes:
            for letter in LETTERS:
                yield parse_effect(f"position-table(E{letter}{axis})", touches.chain)


def tables(
    touches: Touches, variables: Iterable[str], stated: Sequence[Effect], offered: Sequence[Effect]
) -> Iterator[WiderSearch]:
    """Tables, which say where an axis is wrong and not why.

    One is followed only where it predicts plainly better than what the laws came to: it can imitate
    any of them. Several together imitate any function of several axes, so of those that only the
    remainder asks for one is taken, and only if nothing remains beside it.

    Args:
        variables: On which what is left depends.
        stated: Those that the library proposes for the run.
    """
    share, known = POLICY.error_share, {e.name for e in (*offered, *stated)}
    asked = [e for e in tables_along(touches, variables) if e.name not in known]
    for new, is_alone in ((stated, False), (asked, True)):
        names = frozenset(e.name for e in new)
        if new and not names & {e.name for e in offered}:
            yield WiderSearch((*offered, *new), names, share=share, is_alone=is_alone)
