"""Effects that explain the same touches equally well and cannot be distinguished."""

from collections.abc import Collection, Sequence
from dataclasses import dataclass, replace

import numpy as np

from matstd.diagnosis.answer.alike import Alike
from matstd.diagnosis.evidence import (
    EffectSet,
    ScaledEffect,
    Signatures,
    addition,
    projected,
    ranked,
    scanned_grids,
    score_all,
    signatures,
)
from matstd.diagnosis.policy import POLICY
from matstd.diagnosis.search import explained, follows_driver, is_series, refined
from matstd.twin.frames import Array
from matstd.twin.model import Effect, columns, original_of, traits
from matstd.twin.record import Instrument, Touches
from matstd.twin.thermal import drives

LISTED_FAR = 2
"""Candidates far behind that are refined too: one that says how far the next explanation outside
the class is, and a second, since the first may be the effect itself."""

MAX_RIVALS = 40
"""Most rivals that are refined, the most likely first; a larger class would not help a reader."""


@dataclass(frozen=True, slots=True, eq=False)
class Rival:
    """An effect that explains what another one explains."""

    sized: ScaledEffect
    # evidence for the named effect against this one, in natural logarithms; small or negative where
    # the run cannot distinguish them
    log_odds: float
    overlap: float  # correlation of what the two explain, 1 where the signatures coincide

    @property
    def effect(self) -> Effect:
        """The effect itself."""
        return self.sized.effect


@dataclass(frozen=True, slots=True, eq=False)
class ConfusionClass:
    """A found effect with all effects that the run cannot distinguish from it."""

    sized: ScaledEffect  # the named one: most evidence, ties broken by what is usual
    rivals: tuple[Rival, ...]  # not distinguished, most likely first
    distinguished: tuple[Rival, ...]  # next in line, but clearly less likely
    # of a periodic effect every other period not distinguished from the named one; None where there
    # is none
    alike: Alike | None = None

    @property
    def effect(self) -> Effect:
        """The named effect itself."""
        return self.sized.effect

    @property
    def runner_up(self) -> Rival | None:
        """The next best explanation outside the class, however far behind."""
        return next(iter(self.distinguished), None)

    def headed(self, sized: ScaledEffect) -> "ConfusionClass":
        """The class with another of its members named: the one that was weighed."""
        if sized.effect.name == self.effect.name:
            return replace(self, sized=sized)
        own = (Rival(self.sized, 0.0, 1.0), *self.rivals)
        return replace(self, sized=sized, rivals=own).beside({sized.effect.name})

    def beside(self, names: Collection[str]) -> "ConfusionClass":
        """The class without effects that are in the set already, under these names."""
        return replace(
            self,
            rivals=tuple(r for r in self.rivals if r.effect.name not in names),
            distinguished=tuple(r for r in self.distinguished if r.effect.name not in names),
        )


def acts_as_instrument(effect: Effect, touches: Touches) -> bool:
    """Whether an instrument beside the machine that drifts or slips reads the same as an effect.

    So it is of an instrument that reads in one direction, where the effect would be the same with
    every axis at one reading, reached without a direction: what depends on neither follows the time
    or a drive, as the instrument may, too.
    """
    is_machine = touches.instrument.reads_by_the_axes or touches.instrument is Instrument.CMM
    if is_machine or np.ptp(touches.normal, axis=0).max() > 1e-6:
        return False
    middle = np.broadcast_to(np.median(touches.q, axis=0), touches.q.shape)
    still = replace(touches, q=middle, commanded=None, approach=np.zeros_like(touches.approach))
    return bool(np.allclose(columns([effect], still), columns([effect], touches), rtol=1e-6))


def plausibility(effects: Sequence[Effect], touches: Touches) -> dict[str, float]:
    """Log prior odds of effects by name, for ties alone.

    Every family - a kind, and apart from it the same kind after a sensor - is as likely as every
    other, and shares its weight among its members; a sensor is likely to explain the axis whose
    letter it bears, and what follows no sensor supposes less.
    """
    chosen = POLICY.log_odds_unrecorded + float(np.log(max(len(drives(touches)), 1)))
    drivers = [traits(original_of(e)).driver for e in effects]
    labels = [(e.kind, d in touches.temperature) for e, d in zip(effects, drivers, strict=True)]
    return {
        e.name: POLICY.log_odds_own_sensor * (is_sensor and driver.endswith(_axis(e)))
        - chosen * follows_driver(e)
        - POLICY.log_odds_series * is_series(e, touches.chain)
        - float(np.log(labels.count((kind, is_sensor))))
        for e, driver, (kind, is_sensor) in zip(effects, drivers, labels, strict=True)
    }


def _axis(effect: Effect) -> str:
    """Axis on which an effect acts; of the standard a word in which no sensor's name ends."""
    own = traits(original_of(effect))
    return (own.symbol.link if own.symbol else own.axis) or " "


def confusion_class(
    pool: Signatures, found: ScaledEffect, base: EffectSet, others: Collection[str]
) -> ConfusionClass:
    """Everything that explains what a found effect explains, with the other effects in place.

    Args:
        base: The set without the effect.
        others: Names of the effects in it.
    """
    complement = pool.complement
    scores = score_all(base, pool)
    top, _ = addition(base, found.effect)
    names = {found.effect.name, *others}
    rivals = [Rival(found, 0.0, 1.0)]
    own = explained(base, projected(complement, [found]))
    least = min(top, _on_grid(base, found)) - POLICY.log_odds_ruled_out
    for variant in _ranked(pool, scores.evidence, least, base.evidence):
        candidate = pool.variants[variant]
        if candidate.name in names:
            continue
        sized, evidence = refined(base, candidate, levels=2)
        overlap = float(abs(own @ explained(base, projected(complement, [sized]))))
        rivals.append(Rival(sized, float(top - evidence), overlap))
    return _ordered(rivals, plausibility([r.effect for r in rivals], complement.touches))


def _on_grid(base: EffectSet, found: ScaledEffect) -> float:
    """Evidence of an effect at the best point of its grid: a large one gains by thousands between.

    Its rivals stand at points of their grids, so there it is held against them.
    """
    grids = scanned_grids([found.effect], base.complement)
    return float(score_all(base, signatures(base.complement, grids, 1)).evidence.max())


def _ranked(pool: Signatures, evidence: Array, least: float, without: float) -> list[int]:
    """Best variant of every candidate with at least some evidence, most first.

    Args:
        without: Evidence without any; what explains less, such as lobes of a probe of which every
            touch has one normal, is no rival however few there are.
    """
    best = pool.first_of_each(ranked(evidence))
    best = best[evidence[best] > without]
    close = int(np.count_nonzero(evidence[best] > least))
    return [int(v) for v in (*best[: min(close, MAX_RIVALS)], *best[close : close + LISTED_FAR])]


def _ordered(found: Sequence[Rival], prior: dict[str, float]) -> ConfusionClass:
    """The class headed by its likeliest member, with odds against it.

    A factor on the usual size is as likely as it is small: 2.5 µm/K of the spindle before 43 µm/K
    of the room.
    """
    likely = [prior[r.effect.name] - r.log_odds - np.log(r.sized.scale) for r in found]
    head, *rest = (found[i] for i in ranked(np.array(likely)))
    shifted = [Rival(r.sized, r.log_odds - head.log_odds, r.overlap) for r in rest]
    close = tuple(r for r in shifted if r.log_odds < POLICY.log_odds_alike)
    return ConfusionClass(
        head.sized, close, tuple(r for r in shifted if r.log_odds >= POLICY.log_odds_alike)
    )
