"""A search that is not misled by coarse grids: refined inner parameters take the grid's place."""

from dataclasses import replace

from diagnosis.evidence import EffectSet, ScaledEffect, projected
from diagnosis.search.refine import moved, refined_set
from diagnosis.search.selection import WORTH, EffectSubset, Search

SETTLINGS = 3
"""Most searches with points of the grid moved to refined inner parameters."""


def settled(search: Search, chosen: EffectSubset) -> tuple[Search, EffectSubset]:
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
        pool = moved(search.pool, {m.variant: s.effect for m, s in pairs})
        search = Search(pool, search.fixed, search.progress, search.budget)
        chosen = search.run([replace(m, effect=s.effect, scale=s.scale) for m, s in pairs])
    return search, chosen
