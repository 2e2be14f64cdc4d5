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
from matstd.diagnosis.residual import PatternTests, Shape, Structure, find_structure
from matstd.diagnosis.search.budget import Budget
from matstd.diagnosis.search.domains import by_time
from matstd.diagnosis.search.edges import (
    restore_predicted_outliers,
    unexplained_near_slip,
    without,
)
from matstd.diagnosis.search.members import EffectSubset, Member
from matstd.diagnosis.search.missing_driver import is_unrecorded, unrecorded
from matstd.diagnosis.search.overtones import with_overtones
from matstd.diagnosis.search.refine import refined_set
from matstd.diagnosis.search.screened import best_set, scaled
from matstd.diagnosis.search.screening import Library
from matstd.diagnosis.search.selection import Search
from matstd.diagnosis.search.tables import tables_along
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


@dataclass(frozen=True, slots=True, eq=False)
class SearchState:
    """Result of the search at given gross errors.

    Attributes:
        base: The starting model, and what the user added, fitted.
        effects: The same effects with their inner parameters refined.
        smooth: Tests for patterns in what the starting model leaves.
        nameless: Patterns without a name that had to be put beside them.
        drifts: Laws of drivers that were not recorded, whose patterns are among these.
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
    drifts: tuple[ScaledEffect, ...] = ()
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
    imitate any of them. Where a remainder depends on an axis, the tables of its components are
    offered too, and one of them is followed only if nothing remains beside it: several together
    imitate any function of several axes.

    Args:
        start: A set to begin with, inner parameters refined, as a choice of the rows gave it: what
            tables there are, it holds.
    """
    begun = {s.effect.name for s in start}
    laws = [e for e in candidates if not traits(e).is_table or e.name in begun]
    state = _with_further_periods(task, added, laws, progress, start)
    if start:
        return state
    if len(laws) < len(candidates):
        other = _with_further_periods(task, added, candidates, progress, ())
        state = other if _held_out(other) < POLICY.error_share * _held_out(state) else state
    known = {e.name for e in candidates}
    depends_on = [v for s in (*state.nameless, *state.left) for v in s.variables]
    tables = [e for e in tables_along(task.run.touches, depends_on) if e.name not in known]
    if not tables:
        return state
    other = _with_further_periods(task, added, [*laws, *tables], progress, ())
    followed = sum(traits(s.effect).is_table for s in other.effects)
    is_whole = followed == 1 and not other.left and not other.nameless
    return other if is_whole and _held_out(other) < POLICY.error_share * _held_out(state) else state


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
        is_taken = {a.name for a in further} & {s.effect.name for s in other.effects}
        if not is_taken or _held_out(other) >= _held_out(state):
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
    nameless = unrecorded(touches)
    whole = task.fit((*added, *start))
    base = task.fit(added, whole.gross, whole) if start else whole
    tried = unexplained_near_slip(touches, base.gross, start)
    if tried.any():
        base = task.fit(added, without(base.gross, tried), whole if start else None)
    found: Sequence[ScaledEffect] = start
    budget = Budget()
    for remaining in reversed(range(MAX_ROUNDS)):
        library = Library.of(ResidualSpace.of(base), [*candidates, *nameless], progress)
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
    nameless: list[Structure] = []
    if not left:
        left = _patterns_that_win(at_start, nothing, chosen)
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
    elif nameless:
        chosen = _both(search, named[1], chosen)
    drifts = tuple(
        ScaledEffect(m.effect, m.scale) for m in chosen.members if is_unrecorded(m.effect)
    )
    library, search, chosen, unnamed = _without_drivers(library, search, chosen)
    return SearchState(
        base=base,
        library=library,
        search=search,
        chosen=chosen,
        effects=tuple(refined_set(library.complement, scaled(chosen))),
        smooth=smooth,
        at_start=tuple(at_start),
        left=tuple(left),
        nameless=(*unnamed, *nameless),
        drifts=drifts,
        is_ended=search.budget.is_spent,
    )


def _without_drivers(
    library: Library, search: Search, chosen: EffectSubset
) -> tuple[Library, Search, EffectSubset, list[Structure]]:
    """A result in which unrecorded drivers are patterns without a name."""
    drifts = [m for m in chosen.members if is_unrecorded(m.effect)]
    found = [_as_pattern(search, chosen, m) for m in drifts]
    library = library.without(is_unrecorded)
    pool = library.sample if library.is_whole else search.pool.without(is_unrecorded)
    blocks = [] if search.fixed is None else [search.fixed]
    blocks += [s.columns for s in found if s.columns is not None]
    fixed = np.hstack(blocks) if blocks else None
    search = Search(pool, fixed, search.progress, search.budget)
    return library, search, search.evaluate(m for m in chosen.members if m not in drifts), found


def _as_pattern(search: Search, chosen: EffectSubset, member: Member) -> Structure:
    """A member of a set as a pattern."""
    others = search.evaluate(m for m in chosen.members if m is not member)
    tested = search.verified(others, chosen, member)
    fall = others.effects.objective - chosen.effects.objective
    return Structure(
        shape=Shape.DRIVER,
        variables=("time_s",),
        direction="normal",
        p_value=tested.p_value,
        share=min(fall / others.effects.objective, 1.0),
        evidence=tested.evidence,
        columns=member.scale * search.pool.columns_of(member.variant),
        law=member.effect.name.partition(": ")[2],
    )


def _evicted(before: EffectSubset, after: EffectSubset) -> bool:
    """Whether nameless patterns replaced named effects without a better prediction.

    They are judged by long stretches of time left out: between neighbours a pattern of time always
    runs well.
    """
    kept = {m.effect.name for m in after.members}
    if all(m.effect.name in kept or is_unrecorded(m.effect) for m in before.members):
        return False
    return _by_stretches(after.effects) > POLICY.error_share * _by_stretches(before.effects)


def _both(search: Search, before: EffectSubset, after: EffectSubset) -> EffectSubset:
    """Names beside the patterns that replaced them, where both predict better than patterns alone.

    Args:
        search: With the patterns in every set.
    """
    kept = {m.effect.name for m in after.members}
    if all(m.effect.name in kept or is_unrecorded(m.effect) for m in before.members):
        return after
    both = search.evaluate(before.members)
    is_better = _by_stretches(both.effects) < POLICY.error_share * _by_stretches(after.effects)
    return both if is_better else after


def _by_stretches(effects: EffectSet) -> float:
    """Held-out error of a set when long stretches of time are left out."""
    complement = effects.complement
    return EffectSet(replace(complement, groups=by_time(complement)), effects.A).held_out.rms


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
