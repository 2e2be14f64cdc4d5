"""One set: what was tested is what is reported, drawn and saved.

A search tests effects at points of a grid, and then two things happen to them: their inner
parameters are refined, and of effects that the run cannot distinguish the likeliest is named.
Either makes another set. So the reported set is tested as it stands, every member beside the
others; a name that fails there is not used, and is reported beside the set.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np

from matstd.diagnosis.answer.alike import periods_alike
from matstd.diagnosis.answer.ambiguity import ConfusionClass, confusion_class
from matstd.diagnosis.evidence import EffectSet, ScaledEffect, projected
from matstd.diagnosis.residual import find_structure
from matstd.diagnosis.search import (
    Member,
    Search,
    SearchState,
    Verified,
    refined,
    with_moved_points,
)


@dataclass(frozen=True, slots=True, eq=False)
class ReportedSet:
    """A set of effects with its tests.

    Attributes:
        state: Of the search, its members the effects as reported.
        classes: What each cannot be distinguished from, none of it in the set.
        tests: Of every member with the others in place, by the name of the effect.
    """

    state: SearchState
    classes: tuple[ConfusionClass, ...]
    tests: Mapping[str, Verified]


def reported_set(final: SearchState) -> ReportedSet:
    """The set of a search as it is reported, with its tests.

    Inner parameters are the refined ones and names those of the likeliest members of every class,
    as far as the set so made passes all tests; else the members of the search are reported.

    Args:
        final: Result of the search; of a set that was chosen by prediction nothing is exchanged.
    """
    state, tests = _refined(final)
    classes = []
    for i, sized in enumerate(state.effects):
        if sized.effect.name in final.chances:
            classes.append(ConfusionClass(sized, (), ()))
            continue
        found = confusion_class(state.pool, state.effects[i], _others(state, i), state.fixed)
        if not final.is_weighed and found.effect.name != sized.effect.name:
            state, tests = _tried(state, tests, i, _beside(state, i, found.sized))
        named, alike = periods_alike(state.effects[i], _others(state, i), _base(state, i))
        if alike is not None:
            state, tests = _tried(state, tests, i, named)
            alike = alike.beside(state.effects[i], named)
        classes.append(replace(found.headed(state.effects[i]), alike=alike))
    names = {s.effect.name for s in state.effects}
    return ReportedSet(state, tuple(c.beside(names) for c in classes), tests)


def _refined(final: SearchState) -> tuple[SearchState, Mapping[str, Verified]]:
    """The set with refined inner parameters where it stands so, with its tests."""
    if final.is_weighed:
        return final, _by_name(final)
    grid = tuple(ScaledEffect(m.effect, m.scale) for m in final.chosen.members)
    state = with_members(final, final.effects)
    tests = _by_name(state)
    if _stands(tests):
        return state, tests
    state = with_members(state, grid)
    return state, _by_name(state)


def _tried(
    state: SearchState, tests: Mapping[str, Verified], i: int, sized: ScaledEffect
) -> tuple[SearchState, Mapping[str, Verified]]:
    """The set with another effect for one of it where all stand then, else as it was."""
    before = state.effects
    other = with_members(state, (*before[:i], sized, *before[i + 1 :]))
    others_tests = _by_name(other)
    if state.is_weighed or _stands(others_tests):
        return other, others_tests
    return with_members(other, before), tests


def with_members(state: SearchState, effects: Sequence[ScaledEffect]) -> SearchState:
    """The state with other effects for its members, one for one, and their points of the grids.

    The signatures are changed in place, so the state that was given is lost.
    """
    places = [
        _place(state, member, sized)
        for member, sized in zip(state.chosen.members, effects, strict=True)
    ]
    moved = {v: s.effect for v, s in zip(places, effects, strict=True)}
    search = state.search
    pool = with_moved_points(search.pool, moved)
    search = Search(pool, search.fixed, search.progress, search.budget)
    members = [
        Member(v, int(pool.owner[v]), s.effect, s.scale)
        for v, s in zip(places, effects, strict=True)
    ]
    chosen = search.evaluate(members)
    return replace(state, search=search, chosen=chosen, effects=tuple(effects))


def _place(state: SearchState, member: Member, sized: ScaledEffect) -> int:
    """Variant whose place an effect takes: that of the member, else one of its own candidate."""
    pool = state.pool
    if pool.variants[member.variant].name == sized.effect.name:
        return member.variant
    return next(i for i, e in enumerate(pool.variants) if e.name == sized.effect.name)


def _others(state: SearchState, i: int) -> tuple[ScaledEffect, ...]:
    return state.effects[:i] + state.effects[i + 1 :]


def _base(state: SearchState, i: int) -> EffectSet:
    """The set without one member."""
    complement = state.pool.complement
    A = projected(complement, _others(state, i))
    return EffectSet(complement, A if state.fixed is None else np.hstack([state.fixed, A]))


def _beside(state: SearchState, i: int, head: ScaledEffect) -> ScaledEffect:
    """An effect refined in the place of a member, beside the rest."""
    return refined(_base(state, i), head.effect)[0]


def _by_name(state: SearchState) -> dict[str, Verified]:
    return {v.member.effect.name: v for v in state.search.verify(state.chosen)}


def _stands(tests: Mapping[str, Verified]) -> bool:
    return all(v.stands for v in tests.values())


def without(state: SearchState, name: str) -> SearchState:
    """The state less one effect of its set; what it explained is left to be explained."""
    kept = [i for i, s in enumerate(state.effects) if s.effect.name != name]
    chosen = state.search.evaluate(state.chosen.members[i] for i in kept)
    effects = tuple(state.effects[i] for i in kept)
    return replace(
        state,
        chosen=chosen,
        effects=effects,
        left=tuple(find_structure(chosen.effects, smooth=state.smooth)),
    )
