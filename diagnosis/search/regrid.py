"""A search that is not misled by coarse grids: refined inner parameters take the grid's place.

Between two points of a grid lies an effect that neither fits. What the better one leaves looks like
a further effect, or like structure. So what was found is refined, its points of the grid are moved
there, and the search is made again from that set: whatever only mopped up the difference falls.
"""

from dataclasses import replace

from diagnosis.evidence import EffectSet, ScaledEffect, projected
from diagnosis.search.refine import refined_set, with_moved_points
from diagnosis.search.selection import WORTH, EffectSubset, Search

SETTLINGS = 3
"""Most searches with points of the grid moved to refined inner parameters."""


def regridded(search: Search, chosen: EffectSubset) -> tuple[Search, EffectSubset]:
    """Search again where refined inner parameters are clearly better than the points of the grid.

    What a coarse grid leaves would otherwise pass for a further effect, or for structure that no
    effect explains.

    Args:
        search: As it was made.
        chosen: Its result.

    Returns:
        The search with the moved points, and its result.
    """
    for _ in range(SETTLINGS):
        start = [ScaledEffect(m.effect, m.scale) for m in chosen.members]
        members = refined_set(search.complement, start)
        effects = EffectSet(search.complement, projected(search.complement, members))
        if effects.evidence < chosen.effects.evidence + WORTH:
            break
        pairs = list(zip(chosen.members, members, strict=True))
        pool = with_moved_points(search.pool, {m.variant: s.effect for m, s in pairs})
        search = Search(pool, search.fixed, search.progress, search.budget)
        chosen = search.run([replace(m, effect=s.effect, scale=s.scale) for m, s in pairs])
    return search, chosen
