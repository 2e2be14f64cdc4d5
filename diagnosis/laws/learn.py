"""Laws that a model lacks, learnt from a run one after the other."""

from collections.abc import Collection, Sequence
from dataclasses import replace
from typing import NamedTuple

import numpy as np

from matstd.diagnosis.fit import Fit
from matstd.diagnosis.laws.acceptance import (
    Refusal,
    held_out,
    holds_between,
    holds_elsewhere,
    holds_where_largest,
    memory_left,
    memory_score,
    prediction_odds,
    predicts_better,
    stands_beside_memory,
)
from matstd.diagnosis.laws.beginning import Beginning, log_odds
from matstd.diagnosis.laws.formulas import Candidate
from matstd.diagnosis.laws.learnt import Learning, LearntLaw, Rival
from matstd.diagnosis.laws.library import nearest_of_library
from matstd.diagnosis.laws.policy import POLICY, LawPolicy
from matstd.diagnosis.laws.screening import Field
from matstd.diagnosis.laws.search import Ground, Searched, search_law
from matstd.diagnosis.laws.space import Space
from matstd.diagnosis.regression import GrossErrors, f_probability
from matstd.diagnosis.residual import apart_elsewhere
from matstd.twin.compute import one_blas_thread
from matstd.twin.frames import Mask
from matstd.twin.laws import Carrier, Law
from matstd.twin.model import Model
from matstd.twin.record import Run, Touches

MIN_TOUCHES_OF_LAW = 30  # fewer leave no law that could be distinguished from another

MIN_EXPLAINED = 4
"""So many gross errors for every shape, and half of them, must follow a law that is learnt from
them: a step beyond which 8 of 780 touches are stands out like 8 chips. Accidents have no law in
common; five that a product of two explained predicted another run with 3.1 um instead of 2.4."""

MOST_TRIED = (
    4  # laws of one search that are tried, one after the other, where the first does not predict
)

FAR_GROSS = 2.0  # gross errors so many times as large as the middle one are not counted among those

STAND_IN = ("level", "time")
"""Natures of variables that may stand for a driver that was not recorded: what was commanded, a
reading or a direction, does not."""

CLOCK_OF_RUN = 0.999  # rank correlation with the time from which a reading is one of its clocks

PROPORTIONAL = ("lin", "lin-from")
"""Shapes that are taken for what they say, since bodies expand in proportion to a temperature."""


@one_blas_thread()
def learn_laws(run: Run, model: Model | None = None, policy: LawPolicy = POLICY) -> Learning:
    """Laws that explain what a model leaves of a run.

    Args:
        model: Machine and effects to begin with; None for the ordinary geometric model.

    Raises:
        NotEnoughData: So few touches that nothing can be said.
    """
    return learn_beside(Beginning.of_run(run, model), policy)


@one_blas_thread()
def learn_beside(
    start: Beginning,
    policy: LawPolicy = POLICY,
    is_searched: bool = False,
    ground: Ground | None = None,
) -> Learning:
    """Laws that explain what a fitted model leaves.

    Args:
        is_searched: Whether effects of the library were looked for before: then one that comes near
            a law takes nothing from it.
        ground: Of another search in the same run.
    """
    white = replace(start, memory=None)
    ground = ground or Ground.of(start.run)
    current = start.fit
    laws: list[LearntLaw] = []
    is_enough = int(current.used.sum()) >= MIN_TOUCHES_OF_LAW
    tried = _Tried(None, current, current, None if is_enough else Refusal.FEW)
    for _ in range(policy.most_laws if is_enough else 0):
        learnt = [one.law for one in laws]
        tried = _tried(start, learnt, current, ground, policy, is_searched)
        tried = _of_gross_errors(start, learnt, tried, ground, policy, is_searched) or tried
        if tried.best is None or not tried.is_kept:
            break
        laws.append(tried.best)
        current = _each_anew(white, laws, tried.fit, policy, ground)
    if laws:
        seen = start.run.touches[current.used]
        laws = [_of_its_run(one, seen, policy) for one in laws]
        current = white.fitted([one.law for one in laws], gross=current.gross)
    learnt = [one.law for one in laws]
    if start.memory is not None and laws:
        start = replace(start, memory=memory_left(current, start.memory))
        current = start.fitted(learnt, gross=current.gross)
    return Learning(
        beginning=start,
        after=current,
        tangent=start.fitted(learnt, True) if laws else start.fit,
        laws=tuple(laws),
        refused=None if tried.is_kept else tried.best,
        refusal=tried.refusal,
        held_out=tuple(held_out(start.fit, current, learnt)),
        policy=policy,
    )


class _Tried(NamedTuple):
    """The best law of a search, fits before and with it, and why it is not kept."""

    best: LearntLaw | None
    before: Fit
    fit: Fit
    refusal: Refusal | None

    @property
    def is_kept(self) -> bool:
        return self.best is not None and self.refusal is None


def _tried(
    start: Beginning,
    laws: Sequence[Law],
    current: Fit,
    ground: Ground,
    policy: LawPolicy,
    is_searched: bool,
    rows: Mask | None = None,
) -> _Tried:
    """The next law beside others, in white noise: the first of a search that predicts.

    Args:
        rows: Gross errors that it has to explain.
    """
    white = replace(start, memory=None)
    searched = _searched(white, laws, current, ground, policy)
    first: _Tried | None = None
    taken = {law.name for law in laws}
    for _ in range(MOST_TRIED):
        best = _learnt(searched, taken)
        if best is None:
            break
        fit = white.fitted([*laws, best.law])
        if rows is not None:
            least = max(MIN_EXPLAINED * len(best.law.factors), 0.5 * rows.sum())
            if (rows & fit.used).sum() < least:
                break
        refusal = _refusal(start, laws, best, (current, fit), policy)
        if refusal is None:
            nearest = nearest_of_library(searched.space)
            best = replace(best, library=nearest, memory=memory_score(current))
            refusal = _by_rival(best, is_searched, policy)
        tried = _Tried(best, current, fit, refusal)
        if first is None or tried.is_kept:
            first = tried
        if refusal is not Refusal.PREDICTION:
            break
        taken.add(best.law.name)
    return first or _Tried(None, current, current, None)


def _searched(
    white: Beginning, laws: Sequence[Law], fit: Fit, ground: Ground, policy: LawPolicy
) -> Searched:
    """What a search finds beside laws, ranked by evidence and by touches left out.

    A formula comes first only if it predicts these at least as well as the best curve and the best
    surface.
    """
    found = search_law(Space.of(fit), ground, policy)
    taken = {law.name for law in laws}
    beyond_chance = [c for c in found.smooth if c.score >= policy.min_score]
    new = [c for c in beyond_chance if _usual(c.law, c.bearer.alike).name not in taken]
    best = {c.law.is_surface: c for c in reversed(new)}.values()
    if not best:
        return found

    def fitted(one: Candidate, gross: GrossErrors | None = None) -> Fit:
        return white.fitted([*laws, _usual(one.law, one.bearer.alike)], gross=gross)

    formula = found.candidates[0]
    with_formula = fitted(formula)

    def odds(smooth: Candidate) -> float:
        own = fitted(smooth)
        rows = own.gross.rows | with_formula.gross.rows
        both = replace(own.gross, rows=rows)
        first, second = (
            fit if np.array_equal(fit.gross.rows, rows) else fitted(one, both)
            for fit, one in ((own, smooth), (with_formula, formula))
        )
        return prediction_odds(first, second)

    ranked = sorted([(odds(c), c) for c in best], key=lambda one: -one[0])
    return found.with_first(*ranked[0][::-1]) if ranked[0][0] > policy.min_score else found


def _of_gross_errors(
    start: Beginning,
    laws: Sequence[Law],
    first: _Tried,
    ground: Ground,
    policy: LawPolicy,
    is_searched: bool,
) -> _Tried | None:
    """A law that gross errors of common size and of one carrier follow; None for none.

    Args:
        first: What was tried without these touches.
    """
    gross = first.before.gross
    rows = _alike(gross)
    is_left = rows & ~(first.fit if first.is_kept else first.before).used
    if is_left.sum() < MIN_EXPLAINED or not _have_carrier(gross, rows, ground.field):
        return None
    fewer = replace(gross, rows=gross.rows & ~rows)
    whole = replace(start, memory=None).fitted(laws, gross=fewer)
    tried = _tried(start, laws, whole, ground, policy, is_searched, rows)
    return tried if tried.is_kept else None


def _have_carrier(gross: GrossErrors, rows: Mask, field: Field) -> bool:
    """Whether one amount of one carrier explains gross errors better than is expected by chance.

    Of n carriers one is expected to explain so much that chance has a probability of 1/n. Four
    touches beyond an edge, of unequal levers, had 0.003.
    """
    score, bearers = gross.score[rows], field.bearers
    for C in (bearer.C[rows] for bearer in bearers):
        left = score - C @ np.linalg.lstsq(C, score)[0]
        drop, rest = float(score @ score - left @ left), float(left @ left)
        if f_probability(drop, C.shape[1], rest, len(C) - C.shape[1]) < 1.0 / len(bearers):
            return True
    return False


def _alike(gross: GrossErrors) -> Mask:
    """Gross errors of common size that a law may explain, (N,): none of a feature that is off."""
    size, rows = np.abs(gross.score), gross.accidents
    middle = np.median(size[rows]) if rows.any() else 0.0
    return np.asarray(rows & (size < FAR_GROSS * middle))


def _of_its_run(one: LearntLaw, seen: Touches, policy: LawPolicy) -> LearntLaw:
    """The law, with what belongs to its run marked among its rivals and itself, and its class.

    A law over a temperature or a level may stand for a driver that was not recorded, which another
    run meets at another temperature. A level that only rose or fell is a clock of the run: a bump
    over such a temperature had odds of e^13 against laws of the time, and predicted another run
    with 2.31 µm instead of 1.34 without a law.

    Args:
        seen: Touches from which it was learnt.
    """
    from scipy.stats import spearmanr  # a quarter of a second, which other commands need not wait

    rivals = [replace(r, law=replace(r.law, is_of_run=not r.law.rests(seen))) for r in one.rivals]
    one = replace(one, rivals=tuple(rivals))
    stand_in = [
        f.driver
        for f in one.law.factors
        if f.driver.nature in STAND_IN and f.shape.word not in PROPORTIONAL
    ]
    is_clock = any(
        abs(spearmanr(seen.time, driver.values(seen)).statistic) > CLOCK_OF_RUN
        for driver in stand_in
        if driver.nature == "level"
    )
    is_open = is_clock or bool(stand_in and one.run_odds < policy.open_driver)
    is_of_run = is_open or not one.law.rests(seen)
    elsewhere = tuple(apart_elsewhere(one.law.carrier, one.alike, seen)) if one.alike else ()
    return replace(one, law=replace(one.law, is_of_run=is_of_run), elsewhere=elsewhere)


def _each_anew(
    white: Beginning,
    laws: list[LearntLaw],
    fit: Fit,
    policy: LawPolicy,
    ground: Ground,
) -> Fit:
    """Every law searched anew with the others in place, until none of them changes.

    The first of several laws is found while the others are part of the noise, and may hold a part
    of them. Another law takes its place where it explains the run better, all charges taken off.

    Args:
        laws: Those that were learnt; the last one with all others in place. Changed in place.
        fit: With all of them.
    """
    waiting = set(range(len(laws) - 1))
    for _ in range(policy.most_turns * len(laws)):
        if not waiting:
            break
        i = min(waiting)
        waiting.remove(i)
        others = set(range(len(laws))) - {i}
        beside = [laws[k].law for k in sorted(others)]
        base = white.fitted(beside)
        searched = _searched(white, beside, base, ground, policy)
        best = _learnt(searched, {law.name for law in beside})
        if best is None or best.score < policy.min_score:
            continue
        is_same = best.law.name == laws[i].law.name
        margin = 0.0 if is_same else policy.shorter
        if best.score < log_odds(fit, base, laws[i].charge) + margin:
            continue
        laws[i] = replace(best, library=laws[i].library, memory=laws[i].memory)
        fit = white.fitted([one.law for one in laws])
        waiting |= set() if is_same else others
    return fit


def _refusal(
    start: Beginning,
    laws: Sequence[Law],
    best: LearntLaw,
    white: tuple[Fit, Fit],
    policy: LawPolicy,
) -> Refusal | None:
    """Why a law is not kept beside others; None where it predicts and is beyond chance.

    Args:
        white: Fits without and with the law, in white noise.
    """
    if best.score < policy.min_score:
        return Refusal.CHANCE
    holds = holds_between(*white, best.law) and holds_elsewhere(*white, best.law)
    holds = holds and holds_where_largest(*white, best.law, policy)
    if not holds or not predicts_better(*white):
        return Refusal.PREDICTION
    if not stands_beside_memory(start, laws, best.law, best.charge, policy):
        return Refusal.MEMORY
    return None


def _by_rival(best: LearntLaw, is_searched: bool, policy: LawPolicy) -> Refusal | None:
    """Which rival of another kind explains more than a law; None for none.

    An effect of the library that explains about as well leaves the law, which predicts: without it
    1.88 um remained of a second run, with it 0.73, with the true law 0.57.
    """
    if best.memory > best.score:
        return Refusal.MEMORY
    is_worse = not is_searched and best.library_odds < -policy.class_odds
    return Refusal.LIBRARY if is_worse else None


def _learnt(searched: Searched, taken: Collection[str]) -> LearntLaw | None:
    """The choice of a search with its rivals; None where there is no candidate.

    Args:
        taken: Names of laws that were refused, or stand beside: a fit knows effects by their names.
    """
    every = [(_usual(c.law, c.bearer.alike), c) for c in searched.candidates]
    every = [(law, c) for law, c in every if law.name not in taken]
    if not every:
        return None
    law, first = every[0]
    alike = [c for c in (first.bearer.carrier, *first.bearer.alike) if c.name != law.carrier.name]
    rivals = [Rival(other, first.score - c.score) for other, c in every[1:]]
    return LearntLaw(
        law=law,
        alike=tuple(alike),
        score=first.score,
        charge=float(searched.space.gained(np.array(first.explained))) - first.score,
        curve=searched.curve,
        drift=searched.drift,
        rivals=tuple(sorted(rivals, key=lambda r: r.log_odds)),
    )


def _usual(law: Law, alike: Sequence[Carrier]) -> Law:
    """The law, of carriers that do the same at that of the axis which it is a function of."""
    for factor in law.factors:
        for carrier in (law.carrier, *alike):
            symbol = carrier.symbol
            if symbol is not None and symbol.link == factor.driver.name and not symbol.is_angular:
                return replace(law, carrier=carrier)
    return law
