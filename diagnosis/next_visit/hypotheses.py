"""Laws that a run cannot decide between, each fitted in full, and what they predict of a visit."""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace

import numpy as np

from matstd.diagnosis.fit import Fit
from matstd.diagnosis.laws import Learning, LearntLaw, log_odds
from matstd.diagnosis.next_visit.discrimination import Predicted
from matstd.twin.effects import setup_errors
from matstd.twin.frames import Array
from matstd.twin.laws import SHAPES, Driver, Factor
from matstd.twin.laws import drivers as variables
from matstd.twin.model import Effect, columns
from matstd.twin.record import Touches

DECIDED = float(np.log(20.0))
"""Log odds from which a law is decided against another."""

MOST_RIVALS, MOST_CARRIERS, MOST_SHAPES = 9, 6, 2
"""Rivals of one law that a plan serves: of them carriers that do the same at every touch of the
run, and other shapes of the same carrier and variables."""


SEEN_MARGIN = 0.1  # mm beyond the readings at which a law was seen: these repeat within less

ACTING_SHARE = 0.05  # share of its largest size from which a law acts at a touch


@dataclass(frozen=True, eq=False)
class Hypothesis:
    """One explanation of what a model leaves."""

    law: Effect  # in it, of the laws that were learnt this one or a rival in its place
    log_odds: float  # of what was learnt against it
    fit: Fit  # with everything that was learnt besides, and the displacements of inner parameters
    is_unseen: bool = False  # whether it is the law, but not at readings where no touch shows it

    def own_effects(self, shared: int) -> tuple[Effect, ...]:
        """Effects beyond the first ones of the model, with their displacements."""
        return (*self.fit.model.effects[shared:], *self.fit.tangents)


def predictions(found: Sequence[Hypothesis], visit: Touches) -> list[Predicted]:
    """What every explanation predicts of a visit, over the noise of a touch.

    Parameters are uncertain as the run leaves them, and the standard is clamped anew.
    """
    noise = float(np.median(found[0].fit.u))
    effects = [one.fit.model.effects for one in found]
    shared = next(
        k for k, same in enumerate(zip(*effects, strict=False)) if len({*map(id, same)}) > 1
    )
    base = columns(effects[0][:shared], visit) / noise
    clamped = setup_errors(visit)
    sd = np.array([p.sd for e in clamped for p in e.parameters])
    placed = columns(clamped, visit) * sd / noise
    out = []
    for one in found:
        own = one.own_effects(shared)
        C = np.hstack([base, columns(own, visit) / noise])
        rows = np.concatenate([np.r_[one.fit.of_effect(e.name)] for e in own])
        rows = np.concatenate([np.arange(base.shape[1]), rows])
        out.append((C @ one.fit.theta[rows], np.hstack([C @ one.fit.spread[rows], placed])))
    return out


def hypotheses(learning: Learning) -> tuple[Hypothesis, ...]:
    """What was learnt, then every explanation that the run has not decided against."""
    laws = [one.law for one in learning.laws]
    if not laws:
        return ()
    out = [Hypothesis(laws[0], 0.0, learning.tangent)]
    for i, one in enumerate(learning.laws):
        for rival, odds in undecided(one):
            beside = [*laws[:i], rival, *laws[i + 1 :]]
            fit = learning.beginning.fitted(beside, True, learning.after.gross)
            out.append(Hypothesis(rival, odds, fit))
    return tuple(out)


def unseen(learning: Learning) -> Iterator[Hypothesis]:
    """The first law with another sign from the other side, or only where it was seen.

    A run of few poses shows a law at few readings of the other axes, and often from one side: of
    two variables the search then finds one, since that law is the shorter. A direction has two
    values, and a visit settles it; of other readings it leaves some, and they plan no visit alone.
    """
    laws = [one.law for one in learning.laws]
    if not laws or len(laws[0].factors) > 1 or laws[0].is_curve_alone:
        return
    law, *others = laws
    touches, fit = learning.before.run.touches, learning.tangent
    size = np.abs(columns([law], touches) @ fit.theta[fit.of_effect(law.name)])
    acts = size > ACTING_SHARE * size.max()
    for driver in variables(touches):
        second = _second(driver, driver.values(touches)[acts])
        if driver in law.drivers or second is None:
            continue
        factor, places = second
        product = replace(law, factors=(*law.factors, factor), places=(*law.places, *places))
        other = learning.beginning.fitted([product, *others], True, learning.after.gross)
        against = log_odds(fit, other, 0.0)
        if against < DECIDED:
            policy = learning.policy
            charge = policy.tried_products - policy.tried_singles
            yield Hypothesis(product, against + charge, other, driver.nature != "sign")


def _second(driver: Driver, seen: Array) -> tuple[Factor, tuple[float, ...]] | None:
    """A second factor of the same size at all values seen; None of other variables."""
    if driver.nature == "sign" and not driver.name.startswith("trend-"):
        return Factor(SHAPES["sign"], driver), ()
    if driver.nature == "linear":
        return Factor(SHAPES["window"], driver), (
            seen.min() - SEEN_MARGIN,
            seen.max() + SEEN_MARGIN,
        )
    return None


def undecided(one: LearntLaw) -> list[tuple[Effect, float]]:
    """Rivals of a law that its run has not decided against, with the odds against them."""
    alike = [replace(one.law, carrier=carrier) for carrier in one.alike[:MOST_CARRIERS]]
    found: list[tuple[Effect, float]] = [(law, 0.0) for law in alike]
    if one.library is not None and one.library_odds < DECIDED:
        found.append((one.library.effect, one.library_odds))
    near = [rival for rival in one.rivals if rival.log_odds < DECIDED]
    own = one.law.explanation
    seen = {own}
    for rival in near:  # the nearest of every carrier and variables
        if rival.law.explanation not in seen:
            seen.add(rival.law.explanation)
            found.append((rival.law, rival.log_odds))
    shapes = [
        r for r in near if r.law.explanation == one.law.explanation and r.law.name != one.law.name
    ]
    return [*found[:MOST_RIVALS], *((r.law, r.log_odds) for r in shapes[:MOST_SHAPES])]
