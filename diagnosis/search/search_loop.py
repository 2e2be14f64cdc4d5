"""Gross errors, effects and structure in turn, until nothing changes.

Three findings depend on one another: a touch is a gross error only beside the right effects, an
effect is found only among touches that are none, and a pattern without a name counts only for what
no effect explains. So they are looked for in turn:

1. the starting model is fitted, and gross errors are set aside;
2. the library is searched for the set of effects that the touches in use ask for;
3. the model is fitted again with that set, and gross errors are looked for anew; if they have
   changed, or lie at an edge in time where a slip may explain them, or if the set leaves far less
   noise, it begins again with what the set left;
4. once they stay, what the set leaves is tested for structure. Structure joins the set as a pattern
   without a name, and the effects must stand beside it: what only imitated it falls.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace

import numpy as np

from matstd.diagnosis.evidence import (
    EffectSet,
    Progress,
    ResidualSpace,
    ScaledEffect,
    Signatures,
    period_of,
    projected,
    quiet,
    scanned_grids,
    signatures,
)
from matstd.diagnosis.fit import Fit
from matstd.diagnosis.policy import POLICY
from matstd.diagnosis.residual import PatternTests, Structure, find_structure
from matstd.diagnosis.search.edges import unexplained_near_slip, without
from matstd.diagnosis.search.overtones import with_overtones
from matstd.diagnosis.search.refine import refined_set
from matstd.diagnosis.search.restore_outliers import restore_predicted_outliers
from matstd.diagnosis.search.screened import best_set, scaled
from matstd.diagnosis.search.screening import Library
from matstd.diagnosis.search.selection import Budget, EffectSubset, Search
from matstd.diagnosis.search.task import DiagnosisTask
from matstd.twin.effects import repeat
from matstd.twin.frames import Array
from matstd.twin.model import Effect, traits
from matstd.twin.numbers import rms

MAX_ROUNDS = 4
"""Most rounds of looking for gross errors and effects in turn; a usual run needs two."""

MAX_NOISE_SHARE = 0.7
"""Share of the noise, or of the widening of the prior, below which the search is repeated beside
the found effects. A large effect passes for noise and for a machine worse than stated, and the
model then imitates half of everything."""

MAX_PERIODS = 4
"""Most periods of one component error of one axis."""


MAX_NAMELESS = 3
"""Most patterns without a name that are put beside the effects of an unexplained run."""


STRETCHES = 5
"""Stretches of time that are left out to weigh patterns against named effects."""


@dataclass(frozen=True, slots=True, eq=False)
class SearchState:
    """Result of the search at given gross errors.

    Attributes:
        base: The starting model, and what the user added, fitted.
        effects: The same effects with their inner parameters refined.
        smooth: Tests for patterns in what the starting model leaves.
        nameless: Patterns without a name that had to be put beside them.
        chances: Probabilities by chance that rest on blocks left out, by the name of the effect.
        is_weighed: Whether the set was chosen by prediction, and no other may stand in for it.
        is_ended: Whether the search was ended by its limit of sets.
    """

    base: Fit
    library: Library
    search: Search
    chosen: EffectSubset
    effects: tuple[ScaledEffect, ...]
    smooth: PatternTests
    at_start: tuple[Structure, ...]
    left: tuple[Structure, ...]
    nameless: tuple[Structure, ...]
    chances: Mapping[str, float] = field(default_factory=dict)
    is_weighed: bool = False
    is_ended: bool = False

    @property
    def pool(self) -> Signatures:
        """Signatures that were searched."""
        return self.search.pool

    @property
    def fixed(self) -> Array | None:
        """Columns of the patterns without a name."""
        return self.search.fixed


def refined_named(
    task: DiagnosisTask, named: Sequence[Effect], progress: Progress = quiet
) -> tuple[ScaledEffect, ...]:
    """Named effects with their inner parameters at the best point of their grids, refined."""
    if not named:
        return ()
    complement = ResidualSpace.of(task.fit())
    grids = scanned_grids(named, complement)
    search = Search(signatures(complement, grids, len(grids), progress))
    chosen = search.evaluate(())
    for _ in named:
        best = search.ranking(chosen)[0]
        chosen = search.evaluate((*chosen.members, search.member(chosen, best)))
    ordered = sorted(search.polished(chosen).members, key=lambda m: m.candidate)
    return tuple(refined_set(complement, [ScaledEffect(m.effect, m.scale) for m in ordered]))


def search_until_stable(
    task: DiagnosisTask,
    added: Sequence[ScaledEffect],
    candidates: Sequence[Effect],
    progress: Progress = quiet,
    start: Sequence[ScaledEffect] = (),
) -> SearchState:
    """Search among laws, then with tables, which say where an axis is wrong and not why.

    A table is followed only where it predicts plainly better than what the laws came to: it can
    imitate any of them.

    Args:
        start: A set to begin with, inner parameters refined, as a choice of the rows gave it: what
            tables there are, it holds.
    """
    begun = {s.effect.name for s in start}
    laws = [e for e in candidates if not traits(e).is_table or e.name in begun]
    state = _with_further_periods(task, added, laws, progress, start)
    if start or len(laws) == len(candidates):
        return state
    other = _with_further_periods(task, added, candidates, progress, ())
    return other if _held_out(other) < POLICY.error_share * _held_out(state) else state


def _held_out(state: SearchState) -> float:
    """Error of poses left out by what was found, without patterns that have no name, mm."""
    complement = state.library.complement
    effects = EffectSet(complement, projected(complement, state.effects))
    return rms(effects.held_out.error * complement.u)


def _with_further_periods(
    task: DiagnosisTask,
    added: Sequence[ScaledEffect],
    candidates: Sequence[Effect],
    progress: Progress,
    start: Sequence[ScaledEffect],
) -> SearchState:
    """Search, and again with further periods of what repeats where structure is left.

    A screw and its encoder repeat with two periods. A second one is offered only beside a first,
    and only where something is left.
    """
    names = {e.name for e in candidates}
    offered = [*candidates, *(s.effect for s in start if s.effect.name not in names)]
    state = _until_gross_errors_stay(task, added, offered, progress, start)
    for number in range(2, MAX_PERIODS + 1):
        state, offered = _as_one_period(task, added, offered, progress, state)
        before = {s.effect.name for s in state.effects}
        found = [e for e in offered if e.name in before and period_of(e, state.library.complement)]
        first = [e for e in found if traits(e).repetition == 1]
        further = [a for e in first if (a := repeat(e, number)) is not None]
        if not further or not _is_open(state):
            break
        offered += further
        other = _until_gross_errors_stay(task, added, offered, progress, start)
        if not {a.name for a in further} & {s.effect.name for s in other.effects}:
            break
        state = other
    return state


def _is_open(state: SearchState) -> bool:
    """Whether a pattern remains, or more noise than a user may misstate.

    No smooth pattern follows a wave that is short beside the travel.
    """
    chosen = state.chosen.effects
    noise = state.base.noise.factor * float(np.sqrt(chosen.objective / max(chosen.dof, 1.0)))
    return bool(state.left or state.nameless) or noise > POLICY.noise_ratio_open


def _as_one_period(
    task: DiagnosisTask,
    added: Sequence[ScaledEffect],
    offered: list[Effect],
    progress: Progress,
    state: SearchState,
) -> tuple[SearchState, list[Effect]]:
    """Waves that are whole fractions of one period searched as one, where that predicts better."""
    start = with_overtones(state.library.complement, state.effects)
    if start is None:
        return state, offered
    kept = {s.effect.name for s in start} - {start[-1].effect.name}
    gone = {s.effect.name for s in state.effects} - kept
    others = [e for e in offered if e.name not in gone or traits(e).repetition == 1]
    others.append(start[-1].effect)
    other = _until_gross_errors_stay(task, added, others, progress, start)
    is_taken = start[-1].effect.name in {s.effect.name for s in other.effects}
    if is_taken and _held_out(other) < _held_out(state):
        return other, others
    return state, offered


def _until_gross_errors_stay(
    task: DiagnosisTask,
    added: Sequence[ScaledEffect],
    candidates: Sequence[Effect],
    progress: Progress,
    start: Sequence[ScaledEffect],
) -> SearchState:
    """Search in turns, until the gross errors stay what they are.

    Gross errors beside an edge in time are offered to the search once: it may find the slip that
    explains them, and if not they are gross errors in the next turn.
    """
    touches = task.run.touches
    whole = task.fit((*added, *start))
    base = task.fit(added, whole.gross, whole) if start else whole
    tried = unexplained_near_slip(touches, base.gross, start)
    if tried.any():
        base = task.fit(added, without(base.gross, tried), whole if start else None)
    found: Sequence[ScaledEffect] = start
    budget = Budget()
    for remaining in reversed(range(MAX_ROUNDS)):
        library = Library.of(ResidualSpace.of(base), candidates, progress)
        search, chosen = best_set(library, found, budget, progress)
        effects = refined_set(library.complement, scaled(chosen))
        whole = restore_predicted_outliers(task, (*added, *effects), base.gross)
        further = unexplained_near_slip(touches, whole.gross, effects) & ~tried & (remaining > 1)
        is_same = np.array_equal(whole.gross.rows, base.gross.rows) and not further.any()
        if (is_same and not _is_quieter(whole, base)) or not remaining:
            break
        tried |= further
        base = task.fit(added, without(whole.gross, further), whole)
        found = effects
    return _with_structure(base, library, search, chosen, progress)


def _is_quieter(whole: Fit, base: Fit) -> bool:
    """Whether found effects clearly reduce the noise or the widening of the prior."""
    noise, odd = whole.noise.factor, whole.widened
    return noise < MAX_NOISE_SHARE * base.noise.factor or odd < MAX_NOISE_SHARE * base.widened


def _with_structure(
    base: Fit, library: Library, search: Search, chosen: EffectSubset, progress: Progress
) -> SearchState:
    """The search's result with the structure that it leaves, which may bring it down."""
    nothing = search.evaluate(())
    smooth = PatternTests(nothing.effects.complement)
    at_start = find_structure(nothing.effects, progress, smooth)
    left = find_structure(chosen.effects, progress, smooth) if chosen.members else at_start
    if not left:
        left = _patterns_that_win(at_start, nothing, chosen)
    nameless: list[Structure] = []
    named = (search, chosen, left)
    # an unexplained pattern would otherwise be imitated by several named effects
    while any(s.columns is not None for s in left) and len(nameless) < MAX_NAMELESS:
        nameless.append(most_evident(left))
        fixed = np.hstack([s.columns for s in nameless if s.columns is not None])
        search = Search(search.pool, fixed, progress, search.budget)
        chosen = search.run(chosen.members)
        left = find_structure(chosen.effects, progress, smooth)
    if _evicted(named[1], chosen):
        (search, chosen, left), nameless = named, []
    return SearchState(
        base=base,
        library=library,
        search=search,
        chosen=chosen,
        effects=tuple(refined_set(library.complement, scaled(chosen))),
        smooth=smooth,
        at_start=tuple(at_start),
        left=tuple(left),
        nameless=tuple(nameless),
        is_ended=search.budget.is_spent,
    )


def _evicted(before: EffectSubset, after: EffectSubset) -> bool:
    """Whether nameless patterns replaced named effects without a better prediction.

    They are judged by long stretches of time left out: between neighbours a pattern of time always
    runs well.
    """
    kept = {m.effect.name for m in after.members}
    if all(m.effect.name in kept for m in before.members):
        return False
    return _by_stretches(after.effects) > POLICY.error_share * _by_stretches(before.effects)


def _by_stretches(effects: EffectSet) -> float:
    """Held-out error of a set when long stretches of time are left out."""
    complement = effects.complement
    order = np.argsort(complement.touches.time[complement.used], kind="stable")
    groups = tuple(np.array_split(order, STRETCHES))
    return EffectSet(replace(complement, groups=groups), effects.A).held_out.rms


def most_evident(found: Sequence[Structure]) -> Structure:
    """The pattern with most evidence among those that have columns."""
    return max((s for s in found if s.columns is not None), key=lambda s: s.evidence)


def _patterns_that_win(
    at_start: Sequence[Structure], nothing: EffectSubset, chosen: EffectSubset
) -> list[Structure]:
    """Patterns that explain the run clearly better than all found effects together."""
    gained = chosen.effects.evidence - nothing.effects.evidence
    return [
        s
        for s in at_start
        if s.columns is not None and s.evidence > gained + POLICY.log_odds_without_name
    ]
