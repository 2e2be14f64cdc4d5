"""A search that is not misled by coarse grids: refined inner parameters take the grid's place.

Between two points of a grid lies an effect that neither fits. What the better one leaves looks like
a further effect, or like structure. So what was found is refined, its points of the grid are moved
there, and the search is made again from that set: whatever only mopped up the difference falls.
"""

from collections.abc import Sequence
from dataclasses import replace

from matstd.diagnosis.evidence import EffectSet, Grid, ScaledEffect, projected, signatures
from matstd.diagnosis.fit import continuous_inner
from matstd.diagnosis.policy import POLICY
from matstd.diagnosis.search.refine import refined_set, with_moved_points
from matstd.diagnosis.search.selection import EffectSubset, Member, Search

MAX_SEARCHES = 3
"""Most searches with points of the grid moved to refined inner parameters."""


def regridded(search: Search, chosen: EffectSubset) -> tuple[Search, EffectSubset]:
    """Search again where refined inner parameters are clearly better than the points of the grid.

    What a coarse grid leaves would otherwise pass for a further effect, or for structure that no
    effect explains.

    Returns:
        The search with the moved points, and its result.
    """
    for _ in range(MAX_SEARCHES):
        start = [ScaledEffect(m.effect, m.scale) for m in chosen.members]
        members = refined_set(search.complement, start)
        effects = EffectSet(search.complement, projected(search.complement, members))
        kept, members = _needed(search, chosen.members, members)
        is_better = effects.evidence >= chosen.effects.evidence + POLICY.log_evidence_gain
        if len(kept) == len(chosen.members) and not is_better:
            break
        pool = with_moved_points(
            search.pool, {m.variant: s.effect for m, s in zip(kept, members, strict=True)}
        )
        search = Search(pool, search.fixed, search.progress, search.budget)
        moved = zip(kept, members, strict=True)
        chosen = search.run([replace(m, effect=s.effect, scale=s.scale) for m, s in moved])
    return search, chosen


def _needed(
    search: Search, chosen: Sequence[Member], members: Sequence[ScaledEffect]
) -> tuple[list[Member], list[ScaledEffect]]:
    """The set without members that become redundant once the others are refined without them."""
    complement = search.complement
    for i in reversed(range(len(chosen))):
        others = [s for k, s in enumerate(members) if k != i]
        if not any(continuous_inner(s.effect, complement.touches) for s in others):
            continue
        others = refined_set(complement, others)
        ordered = [*chosen[:i], *chosen[i + 1 :], chosen[i]]
        grids = [
            Grid(s.effect, (s.effect,), int(search.pool.tries[m.candidate]))
            for m, s in zip(ordered, [*others, members[i]], strict=True)
        ]
        pool = signatures(complement, grids, search.pool.tried)
        each = [Member(k, k, s.effect, s.scale) for k, s in enumerate([*others, members[i]])]
        small = Search(pool, search.fixed, search.progress, search.budget)
        base, whole = small.evaluate(each[:-1]), small.evaluate(each)
        if not small.verified(base, whole, each[-1]).stands:
            return [*chosen[:i], *chosen[i + 1 :]], others
    return list(chosen), list(members)
