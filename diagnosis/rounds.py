"""Gross errors, effects and structure in turn, until nothing changes."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace

import numpy as np

from diagnosis.candidates import (
    Complement,
    Progress,
    Signatures,
    Sized,
    quiet,
    signatures,
    whole_grids,
)
from diagnosis.edges import offered, without
from diagnosis.evidence import EffectSet
from diagnosis.fit import Fit, fit_run
from diagnosis.gross import GrossErrors
from diagnosis.memory import Memory
from diagnosis.prior import Prior
from diagnosis.refine import refined_set
from diagnosis.screening import Library
from diagnosis.selection import Budget, Chosen, Search
from diagnosis.settle import settled
from diagnosis.structure import Structure, find_structure
from twin.effect import Effect
from twin.frames import Array
from twin.model import Model
from twin.run import Run

ROUNDS = 4
"""Most rounds of looking for gross errors and effects in turn."""

NAMELESS = 3
"""Most patterns without a name that are put beside the effects of an unexplained run."""

CLEARLY = 15.0
"""Log odds by which one pattern without a name must beat all library effects together to say that
they only imitate it."""

SCREENINGS = 3
"""Most screenings of the library in one round of a long run."""

STRETCHES = 5
"""Stretches of time that are left out to weigh patterns against named effects."""

BETTER = 0.8
"""Share of the held-out error of patterns that named effects must reach to stay beside them: an
effect that only imitates an unknown law is rarely much better than a pattern."""

FREEDOM = 3.0
"""Factor on the prior of a found effect in its last fit: being found tells more of its size than
what is usual, and an estimate shall not be drawn to zero."""


@dataclass(frozen=True, slots=True, eq=False)
class Task:
    """What is diagnosed: a run, the model to begin with, and what is believed of it.

    Attributes:
        run: The measurements.
        model: Machine and effects to begin with.
        prior: Of its parameters.
        is_known: Whether the prior is an earlier fit, rather than what is usual.
        memory: Of the noise; None for white noise.
    """

    run: Run
    model: Model
    prior: Prior
    is_known: bool = False
    memory: Memory | None = None

    def fit(
        self,
        effects: Sequence[Sized] = (),
        gross: GrossErrors | None = None,
        free_inner: bool = False,
    ) -> Fit:
        """The model with further effects, fitted; twice where inner parameters are set free."""
        model = Model(self.model.chain, (*self.model.effects, *(s.effect for s in effects)))
        prior = self.prior
        for sized in effects:
            prior = prior.joined(self.found_prior(sized))
        fit = fit_run(self.run, model, prior, gross=gross, memory=self.memory)
        if not free_inner or not effects:
            return fit
        theta = fit.theta[: len(model.parameters)]
        return fit_run(self.run, model, prior, theta, fit.gross, self.memory)

    def found_prior(self, sized: Sized) -> Prior:
        """Of the parameters of an effect that was added."""
        return Prior.of_effects([sized.effect]).widened(FREEDOM * sized.scale)


@dataclass(frozen=True, slots=True, eq=False)
class Round:
    """Result of the search at given gross errors.

    Attributes:
        base: The model to begin with, and what the user added, fitted.
        library: Candidates of the run.
        search: The last search.
        chosen: Its result.
        effects: The same effects with their inner parameters refined.
        at_start: Structure that the model to begin with leaves.
        left: Structure that the effects and the patterns leave.
        nameless: Patterns without a name that had to be put beside them.
        chances: Probabilities by chance that rest on blocks left out, by the name of the effect.
        is_weighed: Whether the set was chosen by prediction, and no other may stand in for it.
    """

    base: Fit
    library: Library
    search: Search
    chosen: Chosen
    effects: tuple[Sized, ...]
    at_start: tuple[Structure, ...]
    left: tuple[Structure, ...]
    nameless: tuple[Structure, ...]
    chances: Mapping[str, float] = field(default_factory=dict)
    is_weighed: bool = False

    @property
    def pool(self) -> Signatures:
        """Signatures that were searched."""
        return self.search.pool

    @property
    def fixed(self) -> Array | None:
        """Columns of the patterns without a name."""
        return self.search.fixed


def tuned(task: Task, named: Sequence[Effect], progress: Progress = quiet) -> tuple[Sized, ...]:
    """Named effects with their inner parameters at the best point of their grids, refined.

    Args:
        task: What is diagnosed.
        named: Effects that the user adds.
        progress: Told of the signatures.
    """
    if not named:
        return ()
    complement = Complement.of(task.fit())
    grids = whole_grids(named, task.run.touches)
    search = Search(signatures(complement, grids, len(grids), progress))
    chosen = search.chosen(())
    for _ in named:
        best = search.ranking(chosen)[0]
        chosen = search.chosen((*chosen.members, search.member(chosen, best)))
    ordered = sorted(search.polished(chosen).members, key=lambda m: m.candidate)
    return tuple(refined_set(complement, [Sized(m.effect, m.scale) for m in ordered]))


def rounds(
    task: Task, added: Sequence[Sized], candidates: Sequence[Effect], progress: Progress = quiet
) -> Round:
    """Search in turns, until the gross errors stay what they are.

    Gross errors beside an edge in time are offered to the search once: it may find the slip that
    explains them, and if not they are gross errors in the next turn.

    Args:
        task: What is diagnosed.
        added: Effects that the user added.
        candidates: Effects that may be found.
        progress: Told of every stage.
    """
    touches = task.run.touches
    base = task.fit(added)
    tried = offered(touches, base.gross, ())
    if tried.any():
        base = task.fit(added, gross=without(base.gross, tried))
    found: Sequence[str] = ()
    budget = Budget()
    for remaining in reversed(range(ROUNDS)):
        library = Library.of(Complement.of(base), candidates, progress)
        search, chosen = _searched(library, found, budget, progress)
        effects = refined_set(library.complement, _sized(chosen))
        again = task.fit((*added, *effects)).gross
        further = offered(touches, again, effects) & ~tried & (remaining > 1)
        is_settled = np.array_equal(again.rows, base.gross.rows) and not further.any()
        if is_settled or not remaining:
            break
        tried |= further
        base = task.fit(added, gross=without(again, further))
        found = [s.effect.name for s in effects]
    return _judged(base, library, search, chosen, progress)


def _judged(
    base: Fit, library: Library, search: Search, chosen: Chosen, progress: Progress
) -> Round:
    """The search's result with the structure that it leaves, which may bring it down."""
    nothing = search.chosen(())
    at_start = find_structure(nothing.effects, progress)
    left = find_structure(chosen.effects, progress) if chosen.members else at_start
    if not left:
        left = _beaten(at_start, nothing, chosen)
    nameless: list[Structure] = []
    named = (search, chosen, left)
    while any(s.columns is not None for s in left) and len(nameless) < NAMELESS:
        nameless.append(strongest(left))
        fixed = np.hstack([s.columns for s in nameless if s.columns is not None])
        search = Search(search.pool, fixed, progress, search.budget)
        chosen = search.run(chosen.members)
        left = find_structure(chosen.effects, progress)
    if _evicted(named[1], chosen):
        (search, chosen, left), nameless = named, []
    return Round(
        base,
        library,
        search,
        chosen,
        tuple(refined_set(library.complement, _sized(chosen))),
        tuple(at_start),
        tuple(left),
        tuple(nameless),
    )


def _evicted(before: Chosen, after: Chosen) -> bool:
    """Whether patterns without a name pushed out named effects that predict better than they do.

    They are judged by long stretches of time left out: between neighbours a pattern of time always
    runs well.
    """
    kept = {m.effect.name for m in after.members}
    if all(m.effect.name in kept for m in before.members):
        return False
    return _by_stretches(before.effects) < BETTER * _by_stretches(after.effects)


def _by_stretches(effects: EffectSet) -> float:
    """Held-out error of a set when long stretches of time are left out."""
    complement = effects.complement
    order = np.argsort(complement.touches.time[complement.used], kind="stable")
    groups = tuple(np.array_split(order, STRETCHES))
    return EffectSet(replace(complement, groups=groups), effects.A).held_out.rms


def _sized(chosen: Chosen) -> list[Sized]:
    return [Sized(m.effect, m.scale) for m in chosen.members]


def _searched(
    library: Library, found: Sequence[str], budget: Budget, progress: Progress
) -> tuple[Search, Chosen]:
    """The best set of effects; of a long run among those that screenings let through."""
    complement = library.complement
    empty = EffectSet(complement, np.zeros((len(complement.residual), 0)))
    names = library.shortlist((), empty)
    for _ in range(SCREENINGS):
        search = Search(library.pool(names), None, progress, budget)
        nothing = search.chosen(())
        ranked = search.ranking(nothing)
        start = [search.member(nothing, v) for v in ranked if search.name_of(v) in found]
        search, chosen = settled(search, search.run(start))
        further = library.shortlist(_sized(chosen), chosen.effects)
        if set(further) <= set(names) or _same(chosen, found):
            break
        names = [*names, *(n for n in further if n not in names)]
        found = [m.effect.name for m in chosen.members]
    return search, chosen


def searched(
    library: Library, found: Sequence[str], budget: Budget, progress: Progress = quiet
) -> list[Sized]:
    """Effects of the best set, without a look at patterns or at gross errors.

    Args:
        library: Candidates.
        found: Names of effects to begin with.
        budget: Sets that may be tried.
        progress: Told of every step.
    """
    return _sized(_searched(library, found, budget, progress)[1])


def _same(chosen: Chosen, found: Sequence[str]) -> bool:
    """Whether a search among more candidates found what was found before."""
    return bool(chosen.members) and {m.effect.name for m in chosen.members} == set(found)


def strongest(found: Sequence[Structure]) -> Structure:
    """The pattern with most evidence among those that have columns."""
    return max((s for s in found if s.columns is not None), key=lambda s: s.evidence)


def _beaten(at_start: Sequence[Structure], nothing: Chosen, chosen: Chosen) -> list[Structure]:
    """Patterns that explain the run clearly better than all found effects together."""
    gained = chosen.effects.evidence - nothing.effects.evidence
    return [s for s in at_start if s.columns is not None and s.evidence > gained + CLEARLY]
