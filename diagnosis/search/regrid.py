"""A search that is not misled by coarse grids: refined inner parameters take the grid's place.

Between two points of a grid lies an effect that neither fits. What the better one leaves looks like
a further effect, or like structure. So what was found is refined, its points of the grid are moved
there, and the search is made again from that set: whatever only mopped up the difference falls.
"""

from collections.abc import Sequence
from dataclasses import replace
from itertools import islice

from matstd.diagnosis.evidence import EffectSet, Grid, ScaledEffect, projected, signatures
from matstd.diagnosis.fit import continuous_inner
from matstd.diagnosis.policy import POLICY
from matstd.diagnosis.search.members import EffectSubset, Member
from matstd.diagnosis.search.missing_driver import follows_driver, is_unrecorded
from matstd.diagnosis.search.refine import refined, refined_set, with_moved_points
from matstd.diagnosis.search.selection import Search
from matstd.twin.model import Effect

MAX_REFINED_DRIVERS = 4
"""Most laws of recorded drivers that are refined beside one that was not recorded."""

MAX_SEARCHES = 3
"""Most searches with points of the grid moved to refined inner parameters."""


def regridded(search: Search, chosen: EffectSubset) -> tuple[Search, EffectSubset]:
    """Search again where refined inner parameters are clearly better than the points of the grid.

    What a coarse grid leaves would otherwise pass for a further effect, or for structure that no
    effect explains.

    Returns:
        The search with the moved points, and its result.
    """
    search, chosen = _with_refined_drivers(search, chosen)
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


def _with_refined_drivers(search: Search, chosen: EffectSubset) -> tuple[Search, EffectSubset]:
    """Search again where the best laws of recorded drivers stand between points of their grids.

    A driver that was not recorded has no grid, and would win by what the grid of a lag loses.
    """
    pool = search.pool
    moved: dict[int, Effect] = {}
    for member in chosen.members:
        if not is_unrecorded(member.effect):
            continue
        others = search.evaluate(m for m in chosen.members if m is not member)
        laws = (v for v in search.ranking(others) if follows_driver(pool.variants[v]))
        for variant in islice(laws, MAX_REFINED_DRIVERS):
            moved[variant] = refined(others.effects, pool.variants[variant])[0].effect
    moved = {v: e for v, e in moved.items() if e != pool.variants[v]}
    if not moved:
        return search, chosen
    search = Search(with_moved_points(pool, moved), search.fixed, search.progress, search.budget)
    return search, search.run(chosen.members)


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
