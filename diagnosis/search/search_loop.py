"""One search for the parts that a run asks for beside the geometry of its machine.

**Parts.** Whatever may explain a run stands in one list: every effect of the library at every point
of the grid of its inner parameters; tables of positions, further periods and periods of several
sines, once a finding asks for them (`further_parts`); laws of drivers that were not recorded;
patterns without a name; and touches that are set aside as gross errors.

**Score.** All are weighed in one projection: what the geometric model could do as well is taken out
of them, and the evidence of a set, with what was believed before, charges it for its freedom
(`evidence`). A set stands only if every member passes the same tests with all the others in place:
chance, evidence, more touches than an accident has, and the prediction of hours and of set-ups that
were left out (`members`).

**Moves.** Add, exchange, move inner parameters between the points of their grids, remove
(`selection`). They end where none improves a set that stands.

**Turns.** A touch is a gross error only beside the right effects, and an effect is found only among
touches that are none. So the model is fitted again with the set, and while that changes the gross
errors, or leaves far less noise, the moves continue from there.

**Patterns.** What a set leaves is tested for structure. A pattern without a name joins as fixed
columns, and the names must stand beside it: several names imitate an unexplained pattern.

**One rule.** Between explanations that were each searched to their end - names alone, patterns with
the names that stand beside them, both; a set with and without what was offered - the simpler comes
first, and a later one replaces it only if it predicts what was held out clearly better
(`clearly_best`, `Policy.error_share`).
"""

from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from typing import TypeVar

import numpy as np

from matstd.diagnosis.accuracy import domains
from matstd.diagnosis.evidence import (
    EffectSet,
    Progress,
    ScaledEffect,
    Signatures,
    projected,
    quiet,
    scanned_grids,
    signatures,
)
from matstd.diagnosis.fit import Fit
from matstd.diagnosis.policy import POLICY
from matstd.diagnosis.residual import PatternTests, Shape, Structure, find_structure
from matstd.diagnosis.search.edges import unexplained_near_slip, without
from matstd.diagnosis.search.further_parts import WiderSearch, further_periods, one_period, tables
from matstd.diagnosis.search.members import EffectSubset, Member, by_blocks
from matstd.diagnosis.search.missing_driver import is_unrecorded, unrecorded
from matstd.diagnosis.search.screening import Budget, Library, joined_shortlists
from matstd.diagnosis.search.selection import Search
from matstd.diagnosis.search.task import DiagnosisTask
from matstd.twin.frames import Array
from matstd.twin.model import Effect, traits
from matstd.twin.numbers import rms

Way = TypeVar("Way")

MAX_ROUNDS = 4  # most rounds of looking for gross errors and effects in turn; a usual run needs two
MAX_SCREENINGS = 3  # most screenings of the library in one round of a long run

MAX_NOISE_SHARE = 0.7
"""Share of the noise, or of the widening of the prior, below which the search is repeated beside
the found effects. A large effect passes for noise and for a machine worse than stated, and the
model then imitates half of everything."""

MAX_NAMELESS = 3
"""Most patterns without a name that are put beside the effects of an unexplained run."""


@dataclass(frozen=True, slots=True, eq=False)
class SearchState:
    """Result of the search at given gross errors."""

    base: Fit  # the starting model, and what the user added, fitted
    library: Library
    search: Search
    chosen: EffectSubset
    smooth: PatternTests  # tests for patterns in what the starting model leaves
    at_start: tuple[Structure, ...]
    left: tuple[Structure, ...]
    nameless: tuple[Structure, ...]  # patterns without a name that had to be put beside the set
    # laws of drivers that were not recorded, whose patterns are among these
    drifts: tuple[ScaledEffect, ...] = ()
    # probabilities by chance that rest on blocks left out, by the name of the effect
    chances: Mapping[str, float] = field(default_factory=dict)
    # whether the set was chosen by prediction, and no other may stand in for it
    is_weighed: bool = False
    is_ended: bool = False  # whether the search was ended by its limit of sets

    @property
    def effects(self) -> tuple[ScaledEffect, ...]:
        """The set."""
        return self.chosen.sized

    @property
    def pool(self) -> Signatures:
        """Signatures that were searched."""
        return self.search.pool

    @property
    def remains(self) -> tuple[Structure, ...]:
        """Patterns beside the set, and what is left then."""
        return (*self.nameless, *self.left)

    @property
    def is_open(self) -> bool:
        """Whether a pattern remains, or more noise than a user may misstate.

        No smooth pattern follows a wave that is short beside the travel.
        """
        chosen = self.chosen.effects
        noise = self.base.noise.factor * float(np.sqrt(chosen.objective / max(chosen.dof, 1.0)))
        return bool(self.remains) or noise > POLICY.noise_ratio_open

    @property
    def named(self) -> EffectSet:
        """The set without patterns that have no name."""
        complement = self.library.complement
        return EffectSet(complement, projected(complement, self.effects))

    @property
    def held_out(self) -> float:
        """Error of poses left out by what was found, without patterns that have no name, mm."""
        effects = self.named
        return rms(effects.held_out.error * effects.complement.u)


def clearly_best(ways: Sequence[Way], error: Callable[[Way], float]) -> Way:
    """The first of some ways, the simplest, unless a later one predicts clearly better."""
    best, least = ways[0], error(ways[0])
    for way in ways[1:]:
        own = error(way)
        if own < POLICY.error_share * least:
            best, least = way, own
    return best


def refined_named(
    task: DiagnosisTask, named: Sequence[Effect], progress: Progress = quiet
) -> tuple[ScaledEffect, ...]:
    """Named effects with their inner parameters at the best point of their grids, refined."""
    if not named:
        return ()
    complement = task.space(task.fit())
    grids = scanned_grids(named, complement)
    search = Search(signatures(complement, grids, len(grids), progress))
    chosen = search.evaluate(())
    for _ in named:
        best = search.ranking(chosen)[0]
        chosen = search.evaluate((*chosen.members, search.member(chosen, best)))
    order = [effect.name for effect in named]
    found = search.refined(search.polished(chosen)).sized
    return tuple(sorted(found, key=lambda s: order.index(s.effect.name)))


def searched(
    task: DiagnosisTask,
    candidates: Sequence[Effect],
    progress: Progress = quiet,
    start: Sequence[ScaledEffect] = (),
) -> SearchState:
    """The set that a run asks for, with what a finding asks for besides.

    Args:
        start: A set to begin with, inner parameters refined, as a choice of the rows gave it: what
            tables there are, it holds.
    """
    known = {e.name for e in candidates}
    begun = {s.effect.name for s in start}
    is_stated = [traits(e).is_table and e.name not in begun for e in candidates]
    stated = [e for e, table in zip(candidates, is_stated, strict=True) if table]
    offered = [e for e, table in zip(candidates, is_stated, strict=True) if not table]
    offered += [s.effect for s in start if s.effect.name not in known]
    state = _settled(task, offered, progress, start)
    tried: set[frozenset[str]] = set()
    while True:
        for wider in _wider(state, offered, stated if not start else None):
            if wider.new in tried:
                continue
            tried.add(wider.new)
            other = _settled(task, wider.candidates, progress, wider.start or start)
            if _is_taken(wider, other) and other.held_out < wider.share * state.held_out:
                state, offered = other, [*wider.candidates]
                break
        else:
            return state


def _wider(
    state: SearchState, offered: Sequence[Effect], stated: Sequence[Effect] | None
) -> Iterator[WiderSearch]:
    """What a finding asks for, the simplest first; no tables in the whole of a long run."""
    complement = state.library.complement
    yield from one_period(complement, state.effects, offered)
    if state.is_open:
        yield from further_periods(complement, state.effects, offered)
    if stated is not None:
        depends_on = [v for s in state.remains for v in s.variables]
        yield from tables(complement.touches, depends_on, stated, offered)


def _is_taken(wider: WiderSearch, state: SearchState) -> bool:
    """Whether a set has what was offered, and as it may."""
    taken = len(wider.new & state.chosen.names)
    return taken == 1 and not state.remains if wider.is_alone else taken > 0


def _settled(
    task: DiagnosisTask,
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
    whole = task.fit_found(start)
    base = task.fit_found((), whole.gross, whole) if start else whole
    tried = unexplained_near_slip(touches, base.gross, start)
    if tried.any():
        base = task.fit_found((), without(base.gross, tried), whole if start else None)
    found: Sequence[ScaledEffect] = start
    budget = Budget()
    for remaining in reversed(range(MAX_ROUNDS)):
        library = Library.of(task.space(base), [*candidates, *nameless], progress)
        search, chosen = best_set(library, found, budget, progress)
        found = chosen.sized
        whole = task.fit_found(found)
        further = unexplained_near_slip(touches, whole.gross, found) & ~tried & (remaining > 1)
        is_same = np.array_equal(whole.gross.rows, base.gross.rows) and not further.any()
        if (is_same and not _is_quieter(whole, base)) or not remaining:
            break
        tried |= further
        base = task.fit_found((), without(whole.gross, further), whole)
    return _beside_patterns(base, library, search, chosen)


def _is_quieter(whole: Fit, base: Fit) -> bool:
    """Whether found effects clearly reduce the noise or the widening of the prior."""
    noise, odd = whole.noise.factor, whole.widened
    return noise < MAX_NOISE_SHARE * base.noise.factor or odd < MAX_NOISE_SHARE * base.widened


def best_set(
    library: Library, found: Sequence[ScaledEffect], budget: Budget, progress: Progress = quiet
) -> tuple[Search, EffectSubset]:
    """The best set of effects, with its search; of a long run among those that screenings pass.

    Args:
        found: A set to begin with.
    """
    complement = library.complement
    shortlist = library.shortlist(found, EffectSet(complement, projected(complement, found)))
    for _ in range(MAX_SCREENINGS):
        search = Search(library.pool(shortlist), None, progress, budget)
        known = [s for s in found if s.effect.name in search.pool.names]
        chosen = search.run([search.placed(s) for s in known])
        if library.is_whole or chosen.names == {s.effect.name for s in found} != set():
            break
        found = chosen.sized
        further = joined_shortlists(shortlist, library.shortlist(found, chosen.effects))
        if further == dict(shortlist):
            break
        shortlist = further
    return search, chosen


def _beside_patterns(
    base: Fit, library: Library, search: Search, chosen: EffectSubset
) -> SearchState:
    """The search's result with the structure that it leaves, beside which the names must stand."""
    progress = search.progress
    nothing = search.evaluate(())
    smooth = PatternTests(nothing.effects.complement)
    at_start = find_structure(nothing.effects, progress, smooth)
    left = find_structure(chosen.effects, progress, smooth) if chosen.members else at_start
    named = (search, chosen, left)
    nameless: list[Structure] = []
    while any(s.columns is not None for s in left) and len(nameless) < MAX_NAMELESS:
        nameless.append(most_evident(left))
        search = Search(search.pool, _joined(nameless), progress, search.budget)
        chosen = search.run(chosen.members)
        left = find_structure(chosen.effects, progress, smooth)
    fallen = {m.effect.name for m in named[1].members if not is_unrecorded(m.effect)} - chosen.names
    if fallen:
        both = search.evaluate(named[1].members)
        # between neighbours a pattern of time always predicts well: long stretches decide
        ways = [named, (search, chosen, left), (search, both, left)]
        search, chosen, left = clearly_best(ways, lambda way: _by_stretches(way[1].effects))
        nameless = [] if search is named[0] else nameless
    drifts = [m for m in chosen.members if is_unrecorded(m.effect)]
    found = [_as_pattern(search, chosen, m) for m in drifts]
    # from here on a driver that was not recorded is a pattern without a name
    pool, library = search.pool, library.without(is_unrecorded)
    pool = library.sample if library.is_whole else pool.without(is_unrecorded)
    last = Search(pool, _joined([*found, *nameless]), progress, search.budget)
    return SearchState(
        base=base,
        library=library,
        search=last,
        chosen=last.evaluate(chosen.others(*drifts)),
        smooth=smooth,
        at_start=tuple(at_start),
        left=tuple(left),
        nameless=(*found, *nameless),
        drifts=tuple(m.sized for m in drifts),
        is_ended=search.budget.is_spent,
    )


def _joined(patterns: Sequence[Structure]) -> Array | None:
    """Columns of some patterns side by side; None where there are none."""
    blocks = [s.columns for s in patterns if s.columns is not None]
    return np.hstack(blocks) if blocks else None


def _as_pattern(search: Search, chosen: EffectSubset, member: Member) -> Structure:
    """A member of a set as a pattern."""
    others = search.evaluate(chosen.others(member))
    tested = search.verified(chosen, member)
    fall = others.effects.objective - chosen.effects.objective
    return Structure(
        shape=Shape.DRIVER,
        variables=("time_s",),
        direction="normal",
        p_value=tested.p_value,
        share=min(fall / others.effects.objective, 1.0),
        evidence=tested.evidence,
        columns=member.scale * member.signature.C,
        law=member.effect.name.partition(": ")[2],
    )


def _by_stretches(effects: EffectSet) -> float:
    """Held-out error of a set when long stretches of time are left out."""
    space = effects.complement
    parts = domains(space.touches, space.used).get("time_s", space.groups)
    return by_blocks(effects, parts).held_out.rms


def most_evident(found: Sequence[Structure]) -> Structure:
    """The pattern with most evidence among those that have columns."""
    return max((s for s in found if s.columns is not None), key=lambda s: s.evidence)
