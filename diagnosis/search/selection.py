"""The moves of the search among sets of effects of one pool: add, exchange, remove, refine.

A first step that is merely the best single one may be a compromise between two real effects; so
every member is offered for exchange whenever another has joined, and where the set with the best
one does not stand, that with another one may. Grids of inner parameters are coarse: between two
points lies an effect that neither fits, and what the better one leaves looks like a further effect.
So members are moved to where the run wants them before another one is looked for. A set stands only
if every member passes its tests (`members`) with the others in place.
"""

from collections.abc import Iterable, Iterator, Sequence
from dataclasses import replace
from functools import cached_property

import numpy as np

from matstd.diagnosis.evidence import (
    Grid,
    Progress,
    ScaledEffect,
    Scores,
    Signatures,
    quiet,
    ranked,
    score_all,
    signatures,
)
from matstd.diagnosis.policy import POLICY
from matstd.diagnosis.search.members import (
    EffectSubset,
    Member,
    Verified,
    explained,
    is_general,
    set_of,
    single,
)
from matstd.diagnosis.search.missing_driver import follows_driver, is_own_sensor, is_unrecorded
from matstd.diagnosis.search.refine import refined_set
from matstd.diagnosis.search.screening import Budget
from matstd.twin.frames import Array, Mask
from matstd.twin.machine import Chain
from matstd.twin.model import Effect, original_of, traits
from matstd.twin.thermal import drives

MIN_CORRELATION_ALIKE = 0.95
"""Correlation of two fitted signatures from which only one of the sets is tried."""

MAX_EXTENSIONS = 4  # most sets of one member more that are tried, until one stands

USUAL_SET_SIZE = 6
"""Effects at which a search is reported as nearly done; it continues while more pass."""


SERIES = ("geometric", "periodic", "coupling")
"""Kinds that, over the turn of an axis, are series of harmonics."""


def is_series(effect: Effect, chain: Chain) -> bool:
    """Whether an effect only describes an error over the turn of an axis."""
    symbol = traits(original_of(effect)).symbol
    is_turned = symbol is not None and chain.link(symbol.link).kind == "rotary"
    return is_turned and original_of(effect).kind in SERIES


class Search:
    """Search among sets of effects of one pool.

    Args:
        fixed: Further columns that are in every set, (N + P, K), such as a pattern without a name.
        budget: Shared with other searches; None for one of its own.
    """

    def __init__(
        self,
        pool: Signatures,
        fixed: Array | None = None,
        progress: Progress = quiet,
        budget: Budget | None = None,
    ) -> None:
        self.pool = pool
        self.budget = budget or Budget()
        self.complement = pool.complement
        self.fixed = fixed
        self.progress = progress
        self._known: dict[tuple[object, ...], tuple[Scores, list[int]]] = {}
        self._products: dict[tuple[object, ...], Array] = {}
        self._candidate = {name: i for i, name in enumerate(pool.names)}

    # --- sets and their scores --------------------------------------------------------------------

    def evaluate(self, members: Iterable[Member]) -> EffectSubset:
        """Put a set into the projection; the budget is charged for it."""
        members = tuple(members)
        effects = set_of(self.complement, members, self.fixed)
        rows, own = effects.A.shape
        self.budget.spend(rows, own, self.pool.C.shape[1])
        prior = sum(self._log_prior(m.effect, int(m.signature.tries[0])) for m in members)
        return EffectSubset(members, effects, float(prior))

    def member(self, chosen: EffectSubset, variant: int) -> Member:
        """A variant as an addition to a set, at its likeliest scale there."""
        return Member(single(self.pool, variant), float(self.scores(chosen).scale[variant]))

    def placed(self, sized: ScaledEffect) -> Member:
        """Any effect as a member, between the points of its grid or beyond the pool."""
        index = self._candidate.get(sized.effect.name)
        tries = 1 if index is None else int(self.pool.tries[index])
        grid = Grid(sized.effect, (sized.effect,), tries)
        return Member(signatures(self.complement, [grid], self.pool.tried), sized.scale)

    def scores(self, chosen: EffectSubset) -> Scores:
        """Scores of all variants as additions to a set."""
        return self._scored(chosen)[0]

    def _scored(self, chosen: EffectSubset) -> tuple[Scores, list[int]]:
        """The same, with the best variant of every candidate, most evidence first; made once."""
        key = tuple(sorted(m.key for m in chosen.members))
        if key not in self._known:
            scores = score_all(chosen.effects, self.pool, self._inside(chosen))
            scores = replace(scores, evidence=scores.evidence + self.prior + chosen.prior)
            # a drift that would not stand must not hide a law that does
            chance = self._is_unrecorded & (scores.p * self.pool.tried >= POLICY.false_alarm)
            order = ranked(np.where(chance, -np.inf, scores.evidence))
            self._known[key] = scores, self.pool.first_of_each(order).tolist()
        return self._known[key]

    def _inside(self, chosen: EffectSubset) -> Array:
        """Inner products of a set's columns with all signatures, (K, M); a member's are made once.

        A long run has few effects that are ever members.
        """
        rows = [self._fixed_product]
        for m in chosen.members:
            if m.key[:-1] not in self._products:
                self._products[m.key[:-1]] = m.signature.C.T @ self.pool.C
            rows.append(m.scale * self._products[m.key[:-1]])
        return np.vstack(rows)

    @cached_property
    def _fixed_product(self) -> Array:
        """The same of the columns that are in every set, if there are any."""
        C = self.pool.C
        return np.zeros((0, C.shape[1])) if self.fixed is None else np.asarray(self.fixed.T @ C)

    def ranking(self, chosen: EffectSubset) -> list[int]:
        """Best variant of every candidate that is not in a set, most evidence first."""
        pool, taken = self.pool, chosen.names
        return [v for v in self._scored(chosen)[1] if pool.names[pool.owner[v]] not in taken]

    @cached_property
    def _is_unrecorded(self) -> Mask:
        """Which variants follow a driver that was not recorded, (V,)."""
        return np.array([is_unrecorded(v) for v in self.pool.variants], dtype=bool)

    @cached_property
    def prior(self) -> Array:
        """Log prior of every variant, (V,)."""
        pool = self.pool
        _, first = np.unique(pool.owner, return_index=True)
        own = [
            self._log_prior(pool.variants[v], int(n))
            for v, n in zip(first, pool.tries, strict=True)
        ]
        return np.asarray(own)[pool.owner] if own else np.zeros(0)

    def _log_prior(self, effect: Effect, tries: int) -> float:
        """What was believed of an effect before the run.

        A law of a recorded driver was chosen among many drivers and lags, and one that was not
        recorded may stand behind it, unless the sensor is that of the body itself. A series over a
        turn imitates the physics of whatever turns.
        """
        if not follows_driver(effect):
            return -POLICY.log_odds_series * is_series(effect, self.complement.touches.chain)
        return float(-np.log(tries) - self._chosen * (not is_own_sensor(effect)))

    @cached_property
    def _chosen(self) -> float:
        """Log odds that a law of a recorded driver pays for the choice of its driver."""
        count = max(len(drives(self.complement.touches)), 1)
        return POLICY.log_odds_unrecorded + float(np.log(count))

    # --- tests ------------------------------------------------------------------------------------

    def stands(self, chosen: EffectSubset) -> bool:
        """Whether every member of a set passes its tests."""
        return all(self.verified(chosen, member).stands for member in chosen.members)

    def verify(self, chosen: EffectSubset) -> list[Verified]:
        """Tests of every member of a set with the others in place."""
        return [self.verified(chosen, member) for member in chosen.members]

    def verified(self, whole: EffectSubset, member: Member) -> Verified:
        """Tests of one member with the others in place."""
        others = self.evaluate(whole.others(member))
        p = float(score_all(others.effects, member.signature).p[0])
        chance = self.corrected(member, p)
        evidence = float(whole.effects.evidence - others.effects.evidence)
        is_beyond_chance = chance < POLICY.false_alarm and evidence > POLICY.log_evidence_gain
        stands = is_beyond_chance and (
            is_unrecorded(member.effect) or is_general(others.effects, whole.effects)
        )
        return Verified(member, chance, evidence, stands)

    def corrected(self, member: Member, p: float) -> float:
        """Probability with the scan of the grid and the number of candidates paid for."""
        return float(min(1.0, p * float(member.signature.tries[0]) * self.pool.tried))

    # --- moves ------------------------------------------------------------------------------------

    def run(self, start: Sequence[Member] = ()) -> EffectSubset:
        """The best set of which every member stands, refined; empty where nothing does.

        Args:
            start: Members of a set to begin with, as from an earlier round.
        """
        best = self.refined(self.polished(self.evaluate(start)))
        return self.backward(self.grown(self.backward(best)))

    def grown(self, best: EffectSubset) -> EffectSubset:
        """A set with one member more and more, refined, as long as every member stands."""
        while not self.budget.is_spent:
            self.progress(min((len(best.members) + 1) / USUAL_SET_SIZE, 1.0), "sets of effects")
            least = best.evidence + POLICY.log_evidence_gain
            sets = map(self.polished, self.extensions(best))
            better = next((s for s in sets if s.evidence > least and self.stands(s)), None)
            if better is None:
                break
            best = self.refined(better)
        return best

    def extensions(self, chosen: EffectSubset) -> Iterator[EffectSubset]:
        """The best sets of one member more, no two alike in what they explain."""
        directions: list[Array] = []
        scores = self.scores(chosen)
        for variant in self.ranking(chosen)[: 12 * MAX_EXTENSIONS]:
            if len(directions) >= MAX_EXTENSIONS or scores.evidence[variant] <= chosen.evidence:
                break
            member = self.member(chosen, variant)
            direction = explained(chosen.effects, member.scale * member.signature.C)
            if all(abs(direction @ d) < MIN_CORRELATION_ALIKE for d in directions):
                directions.append(direction)
                yield self.evaluate((*chosen.members, member))

    def polished(self, chosen: EffectSubset) -> EffectSubset:
        """Exchange members for better ones, one at a time, until none is better."""
        improved = True
        while improved and chosen.members and not self.budget.is_spent:
            improved = False
            for i in range(len(chosen.members)):
                others = self.evaluate(chosen.members[:i] + chosen.members[i + 1 :])
                best = next(iter(self.ranking(others)), None)
                if best is None or self.scores(others).evidence[best] - chosen.evidence <= 1e-6:
                    continue
                members = list(chosen.members)
                members[i] = self.member(others, best)
                chosen, improved = self.evaluate(members), True
        return chosen

    def refined(self, chosen: EffectSubset) -> EffectSubset:
        """The set with its inner parameters where the run wants them, the others in place."""
        moved = refined_set(self.complement, chosen.sized, fixed=self.fixed)
        better = self.evaluate(map(self.placed, moved))
        return better if better.evidence > chosen.evidence else chosen

    def backward(self, chosen: EffectSubset) -> EffectSubset:
        """Take out members that a better one made superfluous, the weakest first."""
        while fallen := [v for v in self.verify(chosen) if not v.stands]:
            weakest = min(fallen, key=lambda v: v.evidence)
            chosen = self.polished(self.evaluate(chosen.others(weakest.member)))
        return chosen
