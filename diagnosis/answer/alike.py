"""Periods that the sampling cannot distinguish.

At targets every s mm a sine of period p reads as one of period p' wherever ``1/p' = k/s ± 1/p``.
Nothing is assumed of the targets here: the evidence is scanned over all periods, and whatever else
explains the run equally well is reported. The named one is not preferred, unless a pitch was
stated. The same holds for waves of a turn, whose period is reported as a harmonic.
"""

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from matstd.diagnosis.evidence import (
    EffectSet,
    Grid,
    ScaledEffect,
    addition,
    period_of,
    score_all,
    signatures,
    strongest,
)
from matstd.diagnosis.policy import POLICY
from matstd.diagnosis.search import refined
from matstd.twin.effects import usual_distance
from matstd.twin.frames import Array
from matstd.twin.model import Effect, Inner, Tunable, is_tunable
from matstd.twin.numbers import significant

MAX_LOST_SHARE = 0.2
"""Share of the square explained by the best period of the scan by which another may fall behind and
still be refined: between two scanned ones up to a tenth is lost."""

MAX_REFINED = 200  # most periods that are refined

SCANS = 6
"""Scans, each four times finer: alike are periods that agree to a part of their uncertainty."""

FINER_BEYOND = 4.0  # periods beyond the scanned ones that are tried to one within them

MAX_UNEVENNESS = 0.02  # largest distance of a target from an even grid, as a share of its step
MAX_FRACTION = 8  # whole fractions of a stated pitch that are preferred to other periods


@dataclass(frozen=True, slots=True, eq=False)
class Alike:
    """A periodic effect at every other period that explains the run as well."""

    axis: str
    others: tuple[ScaledEffect, ...]  # the effect at other periods, longest first, with their sizes
    # distance of the targets, mm, where they stand evenly; None where they do not, and of
    # harmonics: those that even targets confuse are not scanned
    step: float | None
    # stated pitch of the axis, where the named period is a whole fraction of it; None where nothing
    # speaks for the named one
    pitch: float | None
    is_harmonic: bool = False
    # periods longer than the scanned ones that explain as much, mm, the longest first: named by no
    # search, but not excluded by the run
    beyond: tuple[float, ...] = ()

    @property
    def periods(self) -> tuple[float, ...]:
        """The other periods, longest first, mm, or numbers of waves a turn."""
        return tuple(period_value(o.effect) for o in self.others)

    def beside(self, reported: ScaledEffect, named: ScaledEffect) -> "Alike":
        """The same if another period than the one to be named is reported."""
        own = period_value(reported.effect)
        if own == period_value(named.effect):
            return self
        others = [o for o in self.others if abs(period_value(o.effect) - own) > 1e-3 * own]
        return replace(self, others=(named, *others), pitch=None)


def periods_alike(
    found: ScaledEffect, others: Sequence[ScaledEffect], base: EffectSet
) -> tuple[ScaledEffect, Alike | None]:
    """The period to be named of a found effect, and those that the run cannot distinguish from it.

    A whole fraction of a stated pitch is named before others, the longest one where there are
    several; without one it is the longest of all.

    Returns:
        The effect as it was found, and None, where it has no period or no other is like it.
    """
    complement = base.complement
    inner = period_of(found.effect, complement)
    if inner is None:
        return found, None
    assert is_tunable(found.effect)
    link = complement.touches.chain.link(inner.over)
    best = _best(found.effect, inner, base, link.pitch)
    beyond = _beyond(found.effect, inner, base)
    if len(best) < 2 and not beyond:
        return found, None
    taken = [period_value(o.effect) for o in others if period_of(o.effect, complement) is not None]
    best = [b for b in best if all(abs(period_value(b.effect) - t) > 1e-6 * t for t in taken)]
    fraction = [_fraction(period_value(b.effect), link.pitch, inner) for b in best]
    named = int(np.argmin(fraction)) if best else -1
    if named < 0 or (len(best) < 2 and not beyond):
        return found, None
    is_stated = fraction[named] <= MAX_FRACTION
    q = complement.touches.reading(inner.over)[complement.used]
    rest = tuple(b for i, b in enumerate(best) if i != named)
    pitch = link.pitch if is_stated else None
    step = None if inner.is_harmonic else even_step(q)
    alike = Alike(
        axis=inner.over,
        others=rest,
        step=step,
        pitch=pitch,
        is_harmonic=inner.is_harmonic,
        beyond=beyond,
    )
    return best[named], alike


def _best(
    effect: Tunable, inner: Inner, base: EffectSet, pitch: float | None
) -> list[ScaledEffect]:
    """The effect at every period that has the most evidence, or nearly, longest first.

    Whole fractions of a stated pitch are looked at in any case: uneven targets let hundreds of
    periods explain a run about equally well, more than can be refined.
    """
    complement = base.complement
    periods = strongest(effect, inner, complement, base.residual)
    stated = [pitch / k for k in range(1, MAX_FRACTION + 1)] if pitch else []
    stated = [p for p in stated if inner.grid[0] <= p <= inner.grid[-1]]
    scanned = len(periods)
    periods = np.concatenate([periods, stated])
    variants = tuple(effect.tuned(float(p)) for p in periods)
    scores = score_all(base, signatures(complement, [Grid(effect, variants, len(variants))], 1))
    drop = scores.free_drop[:scanned]
    padded = np.concatenate([[-np.inf], drop, [-np.inf]])
    # nothing lies between two harmonics
    is_peak = inner.is_harmonic | ((drop >= padded[:-2]) & (drop >= padded[2:]))
    peaks = np.flatnonzero(is_peak & (drop > (1.0 - MAX_LOST_SHARE) * drop.max()))
    peaks = peaks[np.argsort(-drop[peaks], kind="stable")][:MAX_REFINED]
    looked_at = [*peaks, *range(scanned, len(periods))]
    sized = [refined(base, variants[i], SCANS) for i in looked_at]
    top = max((e for _, e in sized), default=-np.inf)
    close = [s for s, e in sized if top - e < POLICY.log_odds_alike]
    out: list[ScaledEffect] = []
    for s in sorted(close, key=lambda s: period_value(s.effect), reverse=not inner.is_harmonic):
        # two peaks of a scan may climb to one and the same period
        if not out or _apart(out[-1].effect, s.effect, inner):
            out.append(s)
    return out


def _beyond(effect: Tunable, inner: Inner, base: EffectSet) -> tuple[float, ...]:
    """Periods from the longest scanned one up to the travel that explain as much, longest first."""
    travel = float(np.ptp(base.complement.touches.reading(inner.over)[base.complement.used]))
    longest = float(np.max(inner.grid))
    if inner.is_harmonic or travel <= longest:
        return ()
    own, _ = addition(base, effect)
    step = _frequency_step(inner) / FINER_BEYOND
    frequencies = np.arange(1.0 / longest - step, 1.0 / travel, -step)
    gained = np.array([addition(base, effect.tuned(float(1.0 / f)))[0] for f in frequencies])
    padded = np.concatenate([[np.inf], gained, [-np.inf]])  # what rises to the scan is in it
    is_peak = (gained >= padded[:-2]) & (gained > padded[2:])
    close = gained > own - POLICY.log_odds_alike
    return tuple(float(p) for p in (1.0 / frequencies[is_peak & close])[::-1])


def _apart(first: Effect, second: Effect, inner: Inner) -> bool:
    """Whether two periods differ by more than half of what the travel resolves."""
    both = inner.frequency(np.array([period_value(first), period_value(second)]))
    return float(np.ptp(both)) > 0.5 * _frequency_step(inner)


def _frequency_step(inner: Inner) -> float:
    """Distance of the scanned frequencies, 1/mm, or 1/rad."""
    return float(np.median(np.abs(np.diff(inner.frequency(np.asarray(inner.grid))))))


def _fraction(period: float, pitch: float | None, inner: Inner) -> float:
    """Which whole fraction of a stated pitch a period is; infinite for none."""
    if pitch is None:
        return np.inf
    k = round(pitch / period)
    is_fraction = 1 <= k <= MAX_FRACTION and abs(1.0 / period - k / pitch) < _frequency_step(inner)
    return float(k) if is_fraction else np.inf


def period_value(effect: Effect) -> float:
    """Period (mm) or harmonic of an effect that has no other inner parameter."""
    assert is_tunable(effect)
    return float(next(iter(effect.tuning.values())))


def even_step(q: Array) -> float | None:
    """Distance of targets that stand evenly, mm; None where they do not.

    Example:
        >>> even_step(np.array([0.0, 6.0, 12.001, 24.0, 6.002]))
        6.0
        >>> even_step(np.array([0.0, 6.0, 13.0, 30.0])) is None
        True
    """
    step = usual_distance(q) if np.ptp(q) > 0.0 else 0.0
    if step == 0.0:
        return None
    first = float(q.min())
    count = np.round((q - first) / step)
    step = float(count @ (q - first) / max(float(count @ count), 1.0))
    off = np.abs((q - first) / step - np.round((q - first) / step))
    return significant(step, 4) if off.max() < MAX_UNEVENNESS else None
