"""One search among sets of effects, at given gross errors and noise."""

from collections.abc import Sequence

from matstd.diagnosis.evidence import EffectSet, Progress, ScaledEffect, projected, quiet
from matstd.diagnosis.search.budget import Budget
from matstd.diagnosis.search.members import EffectSubset, Member
from matstd.diagnosis.search.refine import with_moved_points
from matstd.diagnosis.search.regrid import regridded
from matstd.diagnosis.search.screening import Library, joined_shortlists
from matstd.diagnosis.search.selection import Search

MAX_SCREENINGS = 3
"""Most screenings of the library in one round of a long run."""


def scaled(chosen: EffectSubset) -> list[ScaledEffect]:
    """Effects of a set with their sizes."""
    return [ScaledEffect(m.effect, m.scale) for m in chosen.members]


def best_set(
    library: Library, found: Sequence[ScaledEffect], budget: Budget, progress: Progress = quiet
) -> tuple[Search, EffectSubset]:
    """The best set of effects; of a long run among those that screenings let through.

    Returns:
        The search, and its result.
    """
    complement = library.complement
    begun = EffectSet(complement, projected(complement, found))
    shortlist = library.shortlist(found, begun)
    for _ in range(MAX_SCREENINGS):
        search, start = _begun(Search(library.pool(shortlist), None, progress, budget), found)
        search, chosen = regridded(search, search.run(start))
        if library.is_whole or _found_again(chosen, found):
            break
        further = library.shortlist(scaled(chosen), chosen.effects)
        if joined_shortlists(shortlist, further) == dict(shortlist):
            break
        shortlist = joined_shortlists(shortlist, further)
        found = scaled(chosen)
    return search, chosen


def _begun(search: Search, found: Sequence[ScaledEffect]) -> tuple[Search, list[Member]]:
    """A search with the effects of an earlier one at their own points of the grids, and these."""
    nothing = search.evaluate(())
    best = {search.name_of(v): v for v in search.ranking(nothing)}
    known = [s for s in found if s.effect.name in best]
    pool = with_moved_points(search.pool, {best[s.effect.name]: s.effect for s in known})
    search = Search(pool, search.fixed, search.progress, search.budget)
    places = [best[s.effect.name] for s in known]
    owners = [int(pool.owner[v]) for v in places]
    return search, [
        Member(v, owner, s.effect, s.scale)
        for v, owner, s in zip(places, owners, known, strict=True)
    ]


def _found_again(chosen: EffectSubset, found: Sequence[ScaledEffect]) -> bool:
    """Whether a search among more candidates found what was found before."""
    names = {m.effect.name for m in chosen.members}
    return bool(names) and names == {s.effect.name for s in found}
