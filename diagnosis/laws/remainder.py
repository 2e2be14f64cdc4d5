"""What a diagnosis leaves, learnt beside the effects that it named, or in their place."""

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from matstd.diagnosis.fit import Fit, Prior
from matstd.diagnosis.laws.beginning import Beginning, log_odds
from matstd.diagnosis.laws.learn import learn_beside
from matstd.diagnosis.laws.learnt import Learning, LearntLaw
from matstd.diagnosis.laws.library import charge_of
from matstd.diagnosis.laws.policy import POLICY, LawPolicy
from matstd.diagnosis.laws.search import Ground
from matstd.diagnosis.regression import GrossErrors
from matstd.twin.compute import one_blas_thread
from matstd.twin.frames import Array
from matstd.twin.model import Effect, traits

IMITATORS = ("thermal-lag", "drift", "artefact-slip", "position-table")
"""Kinds that take the shape of many a law over time or place, and leave nothing of it."""


@one_blas_thread()
def learn_remainder(
    start: Fit,
    end: Fit,
    known: Prior | None = None,
    policy: LawPolicy = POLICY,
    is_left: bool = True,
) -> Learning | None:
    """Laws for what remains at the end of a diagnosis; None where there is nothing to learn.

    Effects that a search named may imitate a law that the library lacks. Laws are therefore learnt
    twice: beside these effects, and in their place. Those in their place are returned where their
    odds against effects and laws together exceed those below which the shorter formula is taken.

    Args:
        start: Of the model without the effects that were found.
        end: With them.
        known: What was known of the starting model from another run.
        is_left: Whether anything remains beside these effects; else laws are learnt only in the
            place of a set of `IMITATORS`.
    """
    base = start.model
    names = {e.name for e in base.effects}
    found = tuple(e for e in end.model.effects if e.name not in names)
    if not is_left and not (found and all(e.kind in IMITATORS for e in found)):
        return None
    rest, instead = policy, policy
    if not is_left:
        rest = replace(policy, most_laws=0)
        # these are functions of one variable each, and nothing is left of another one
        most = min(policy.most_laws, len(found))
        instead = replace(policy, most_laws=most, most_factors=1)
    ground = Ground.of(end.run)
    beside = learn_beside(Beginning.of_fit(end, base, known), rest, True, ground)
    if found:
        begin = Beginning.of_fit(start, base, known)
        alone = learn_beside(begin, instead, True, ground)
        kept = _of_library(alone, found)
        if 0 < len(kept) < len(found):
            found = tuple(e for e in found if e not in kept)
            instead = replace(instead, most_laws=min(instead.most_laws, len(found)))
            begin = Beginning.of_fit(begin.fitted(kept), base, known)
            alone = learn_beside(begin, instead, True, ground)
        odds = _odds(alone, beside, found, len(base.parameters)) if alone.laws else -np.inf
        if odds >= policy.shorter:
            return replace(alone, instead_of=found, instead_odds=odds)
    return beside if is_left else None


def _of_library(alone: Learning, found: Sequence[Effect]) -> list[Effect]:
    """Effects of a kind by which the library explains a law in their place as well or better.

    They stay; only the others may be imitators.
    """
    kinds = {one.library.effect.kind for one in alone.laws if one.library and one.is_of_library}
    return [e for e in found if e.kind in kinds]


def _odds(alone: Learning, beside: Learning, found: Sequence[Effect], count: int) -> float:
    """Log odds of laws alone against effects with what was learnt beside them, on the same rows.

    Tables are curves, against which fewer parameters decide, as they do between two effects of the
    library: a law that it has under another name is charged as that. An effect with a cause that
    explains the run as well as a law with fewer parameters is that cause: a slip that turns nothing
    is a step of a displacement. Laws must therefore explain more than such effects, nothing
    charged.

    Args:
        found: Effects in whose place the laws alone stand.
        count: Number of parameters of the starting model.
    """
    both = (alone, beside)
    gross = replace(alone.after.gross, rows=alone.after.gross.rows | beside.after.gross.rows)
    factor = np.maximum(*(one.after.prior.factor[:count] for one in both))
    fits = [_white(one, one.laws, factor, gross) for one in both]
    charges = [sum(law.charge for law in one.laws) for one in both]
    better = [max(law.library.score - law.score, 0.0) if law.library else 0.0 for law in alone.laws]
    touches, freedom = alone.before.run.touches, max(fits[1].solution.dof, 1.0)
    before = beside.before
    named = sum(charge_of(e, touches, freedom, _determined(before, e)) for e in found)
    odds = log_odds(fits[0], fits[1], charges[0] - sum(better) - charges[1] - named)
    if any(traits(e).is_table for e in found) or all(better):
        return odds
    return min(odds, log_odds(fits[0], _white(beside, (), factor, gross), 0.0))


def _determined(fit: Fit, effect: Effect) -> float:
    """How many parameters of an effect the data determine, its prior the others.

    ``sum (1 - u^2/sd^2)``: the form of a face has 21 coefficients of which a run sees a few.
    """
    rows = fit.of_effect(effect.name)
    u2 = np.diag(fit.covariance)[rows]
    return float(np.clip(1.0 - u2 / fit.prior.sd[rows] ** 2, 0.0, 1.0).sum())


def _white(
    learning: Learning, learnt: Sequence[LearntLaw], factor: Array, gross: GrossErrors
) -> Fit:
    """The model with laws in white noise, on given rows, with one prior of the geometry.

    Args:
        factor: On what is expected of the class of machine, of the first parameters.
    """
    start = learning.beginning
    assert start.prior is not None  # it follows a search
    each = np.pad(factor, (0, len(start.prior) - len(factor)), constant_values=1.0)
    narrowed = each if factor.min(initial=1.0) < 1.0 else None
    prior = Prior(start.prior.mean, each[:, None] * start.prior.root, narrowed)
    white = replace(start, memory=None, prior=prior, is_known=True)
    return white.fitted([one.law for one in learnt], gross=gross)
