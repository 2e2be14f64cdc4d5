"""Choice of the effects that a model lacks: forward with alternatives, swaps, a backward look.

A first step that is merely the best single one may be a compromise between two real effects; so a
few different sets are carried along, and in each every member is offered for exchange whenever
another has joined. A set stands only if every member passes three tests with the others in place:
its probability by chance, corrected for the grid of its inner parameters and for the number of
candidates; the evidence, which charges it for its freedom; and the error of table poses that were
left out of the fit.
"""

from collections.abc import Iterable, Sequence
from dataclasses import replace
from functools import cached_property
from itertools import combinations, count

import numpy as np

from matstd.diagnosis.evidence import (
    Progress,
    Scores,
    Signatures,
    quiet,
    score_all,
)
from matstd.diagnosis.policy import POLICY
from matstd.diagnosis.regression import BoolArray
from matstd.diagnosis.search.budget import Budget
from matstd.diagnosis.search.domains import domain_gain
from matstd.diagnosis.search.instants import p_by_instants
from matstd.diagnosis.search.members import EffectSubset, Member, Verified, effect_set
from matstd.diagnosis.search.missing_driver import follows_driver, is_unrecorded, moves_alike
from matstd.diagnosis.search.tables import contains
from matstd.twin.frames import Array
from matstd.twin.thermal import drives

MIN_CORRELATION_ALIKE = 0.95
"""Correlation of two fitted signatures from which only one of the sets is carried on."""

MAX_CARRIED_SETS = 4
"""Most sets that are carried from one size to the next."""

MAX_REOPENED_SETS = 8
"""Most pairs of members that are taken out for a new start."""

MAX_REOPENINGS = 3
"""Most turns of growing a set and of taking two members out of it."""

USUAL_SET_SIZE = 6
"""Effects at which a search is reported as nearly done; it continues while more pass."""

MAX_LISTED = 25
"""Most candidates that are listed, best first."""


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
        self._known: dict[tuple[tuple[int, float], ...], tuple[Scores, list[int]]] = {}
        self._products: dict[int, Array] = {}

    def evaluate(self, members: Iterable[Member]) -> EffectSubset:
        """Put a set into the projection; the budget is charged for it."""
        members = tuple(members)
        effects = effect_set(self.complement, self.pool, members, self.fixed)
        rows, own = effects.A.shape
        self.budget.spend(rows, own, self.pool.C.shape[1])
        prior = float(sum(self._prior[m.variant] for m in members))
        return EffectSubset(members, effects, prior)

    def member(self, chosen: EffectSubset, variant: int) -> Member:
        """A variant as an addition to a set, at its likeliest scale there."""
        scale, owner = float(self.scores(chosen).scale[variant]), int(self.pool.owner[variant])
        return Member(variant, owner, self.pool.variants[variant], scale)

    def name_of(self, variant: int) -> str:
        """Name of the candidate of a variant."""
        return self.pool.names[self.pool.owner[variant]]

    def scores(self, chosen: EffectSubset) -> Scores:
        """Scores of all variants as additions to a set."""
        return self._scored(chosen)[0]

    def _scored(self, chosen: EffectSubset) -> tuple[Scores, list[int]]:
        """The same, with the best variant of every candidate, most evidence first; made once."""
        key = tuple(sorted((m.variant, m.scale) for m in chosen.members))
        if key not in self._known:
            scores = score_all(chosen.effects, self.pool, self._inside(chosen))
            scores = replace(scores, evidence=scores.evidence + self._prior + chosen.prior)
            # a drift that would not stand must not hide a law that does
            chance = self._is_unrecorded & (scores.p * self.pool.tried >= POLICY.false_alarm)
            order = np.argsort(-np.where(chance, -np.inf, scores.evidence), kind="stable")
            _, first = np.unique(self.pool.owner[order], return_index=True)
            self._known[key] = scores, order[np.sort(first)].tolist()
        return self._known[key]

    def _inside(self, chosen: EffectSubset) -> Array:
        """Inner products of a set's columns with all signatures, (K, M).

        Those of a variant are made once: a long run has few variants that are ever members.
        """
        rows = [self._fixed_product]
        for m in chosen.members:
            if m.variant not in self._products:
                self._products[m.variant] = self.pool.columns_of(m.variant).T @ self.pool.C
            rows.append(m.scale * self._products[m.variant])
        return np.vstack(rows)

    @cached_property
    def _fixed_product(self) -> Array:
        """The same of the columns that are in every set, if there are any."""
        C = self.pool.C
        return np.zeros((0, C.shape[1])) if self.fixed is None else np.asarray(self.fixed.T @ C)

    def ranking(self, chosen: EffectSubset) -> list[int]:
        """Best variant of every candidate that is not in a set, most evidence first."""
        taken = {m.candidate for m in chosen.members}
        return [v for v in self._scored(chosen)[1] if int(self.pool.owner[v]) not in taken]

    def additions(self, chosen: EffectSubset) -> list[int]:
        """The same without candidates that would contain a member."""
        members, variants = [m.effect for m in chosen.members], self.pool.variants
        return [v for v in self.ranking(chosen) if not contains(variants[v], members)]

    def extensions(self, chosen: EffectSubset, most: int) -> list[EffectSubset]:
        """The best sets of one member more, no two alike in what they explain."""
        out: list[EffectSubset] = []
        directions: list[Array] = []
        scores = self.scores(chosen)
        for variant in self.additions(chosen)[: 12 * most]:
            if len(out) >= most or scores.evidence[variant] <= chosen.evidence:
                break
            direction = self.explained(chosen, variant)
            if all(abs(direction @ d) < MIN_CORRELATION_ALIKE for d in directions):
                directions.append(direction)
                out.append(self.evaluate((*chosen.members, self.member(chosen, variant))))
        return out

    def explained(self, chosen: EffectSubset, variant: int) -> Array:
        """Direction of what a variant would explain beyond a set, (N + P,), of length 1."""
        effects = chosen.effects
        C = self.scores(chosen).scale[variant] * self.pool.columns_of(variant)
        E = effects.whiten(C)
        S = C.T @ C - E.T @ E
        g = C.T @ self.complement.residual - E.T @ effects.along
        phi = np.linalg.solve(S + np.eye(len(S)), g)
        direction = C @ phi - effects.A @ effects.coefficients(C @ phi)
        return np.asarray(direction / max(float(np.linalg.norm(direction)), 1e-300))

    def polished(self, chosen: EffectSubset) -> EffectSubset:
        """Exchange members for better ones, one at a time, until none is better."""
        improved = True
        while improved and chosen.members and not self.budget.is_spent:
            improved = False
            for i in range(len(chosen.members)):
                others = self.evaluate(chosen.members[:i] + chosen.members[i + 1 :])
                ranked = self.additions(others)
                best = ranked[0] if ranked else chosen.members[i].variant
                gain = self.scores(others).evidence[best] - chosen.evidence
                if gain > 1e-6:
                    members = list(chosen.members)
                    members[i] = self.member(others, best)
                    chosen, improved = self.evaluate(members), True
        return chosen

    def stands(self, chosen: EffectSubset) -> bool:
        """Whether every member of a set passes its tests, the quick ones first."""
        for i, member in enumerate(chosen.members):
            others = self.evaluate(chosen.members[:i] + chosen.members[i + 1 :])
            p = float(self.scores(others).p[member.variant])
            gained = chosen.effects.evidence - others.effects.evidence
            if (
                self.corrected(member.candidate, p) >= POLICY.false_alarm
                or gained <= POLICY.log_evidence_gain
            ):
                return False
        return all(v.stands for v in self.verify(chosen))

    def verify(self, chosen: EffectSubset) -> list[Verified]:
        """Tests of every member of a set with the others in place."""
        out = []
        for i, member in enumerate(chosen.members):
            others = self.evaluate(chosen.members[:i] + chosen.members[i + 1 :])
            out.append(self.verified(others, chosen, member))
        return out

    def verified(self, others: EffectSubset, whole: EffectSubset, member: Member) -> Verified:
        """Tests of one member, given the set without it and the set with it."""
        density = whole.effects.held_out_log_density - others.effects.held_out_log_density
        count = len(self.complement.u)
        changed = (others.effects.residual - whole.effects.residual)[:count] ** 2
        touches = float(changed.sum()) ** 2 / max(float(changed @ changed), 1e-300)
        p = max(self.scores(others).p[member.variant], p_by_instants(others.effects, whole.effects))
        found = Verified(
            member=member,
            p_value=self.corrected(member.candidate, p),
            evidence=float(whole.effects.evidence - others.effects.evidence),
            held_out=whole.effects.held_out.rms / max(others.effects.held_out.rms, 1e-300),
            density=float(density),
            touches=touches,
            is_possible=self._is_possible(whole, member)
            and self._is_preferred(others, whole, member),
        )
        if not found.stands_by_poses:
            return found
        return replace(found, domain_density=domain_gain(others.effects, whole.effects))

    def _is_preferred(self, others: EffectSubset, whole: EffectSubset, member: Member) -> bool:
        """Whether a recorded driver is more likely than one that was not recorded.

        What the course of such a driver leaves is more likely its own than another driver's.
        """
        if not follows_driver(member.effect):
            return True
        if any(moves_alike(member.effect, m.effect) for m in whole.members):
            return False
        rivals = self.scores(others).evidence[self._is_unrecorded]
        return bool(np.all(whole.evidence > rivals))

    @cached_property
    def _is_unrecorded(self) -> BoolArray:
        """Which variants follow a driver that was not recorded, (V,)."""
        return np.array([is_unrecorded(v) for v in self.pool.variants], dtype=bool)

    @cached_property
    def _prior(self) -> Array:
        """Log prior of every variant, (V,).

        A law of a recorded driver was chosen among many drivers and lags, and one that was not
        recorded may stand behind it.
        """
        touches, pool = self.complement.touches, self.pool
        _, first = np.unique(pool.owner, return_index=True)
        several = max(len(drives(touches)), 1)
        prior = [
            -np.log(several * tries) - POLICY.log_odds_unrecorded
            if follows_driver(pool.variants[v])
            else 0.0
            for v, tries in zip(first, pool.tries, strict=True)
        ]
        return np.asarray(prior)[pool.owner] if prior else np.zeros(0)

    def _is_possible(self, whole: EffectSubset, member: Member) -> bool:
        """Whether a body may expand as a member says, within its uncertainty.

        Only the sign decides: a sensor far from the warm place shows a tenth of its warming, so a
        coefficient may exceed that of every material.
        """
        at = 0 if self.fixed is None else self.fixed.shape[1]
        at += sum(len(m.effect.parameters) for m in whole.members[: whole.members.index(member)])
        effects = whole.effects
        for k, parameter in enumerate(member.effect.parameters, start=at):
            if parameter.unit == "1/K":
                unit = parameter.sd * member.scale
                margin = POLICY.impossible_ratio * unit * effects.spread(k)
                alpha = unit * float(effects.phi[k])
                if not -margin < alpha - POLICY.expansion_least:
                    return False
        return True

    def corrected(self, candidate: int, p: float) -> float:
        """Probability with the scan of the grid and the number of candidates paid for."""
        return float(min(1.0, p * self.pool.tries[candidate] * self.pool.tried))

    def run(self, start: Sequence[Member] = ()) -> EffectSubset:
        """The best set of which every member stands; empty where nothing does.

        Args:
            start: Members of a set to begin with, as from an earlier round.
        """
        best = self.backward(self.polished(self.evaluate(start)))
        for _ in range(MAX_REOPENINGS):
            best = self.backward(self.grown(best))
            other = self.reopened(best)
            if other.evidence <= best.evidence + POLICY.log_evidence_gain or not self.stands(other):
                break
            best = other
        return best

    def grown(self, best: EffectSubset) -> EffectSubset:
        """A set with one member more and more, as long as every member stands."""
        carried = [best]
        for size in count(len(best.members) + 1):
            if self.budget.is_spent:
                break
            grown = [s for c in carried for s in self.extensions(c, MAX_CARRIED_SETS)]
            carried = self.kept(
                self.polished(s) for s in grown[: MAX_CARRIED_SETS * MAX_CARRIED_SETS]
            )
            self.progress(min(size / USUAL_SET_SIZE, 1.0), "sets of effects")
            better = [c for c in carried if c.evidence > best.evidence + POLICY.log_evidence_gain]
            standing = next((c for c in better if self.stands(c)), None)
            if standing is None:
                break
            best = standing
        return best

    def reopened(self, chosen: EffectSubset) -> EffectSubset:
        """The best set with two of its members out and two others in, or the set itself.

        Two effects may replace two others, each the best beside the other; single exchanges
        do not find that.
        """
        best = chosen
        for pair in combinations(chosen.members, 2):
            if self.budget.is_spent:
                break
            rest = self.evaluate(m for m in chosen.members if m not in pair)
            for first in self.extensions(rest, MAX_REOPENED_SETS):
                for second in self.extensions(first, 1):
                    found = self.polished(second)
                    if found.evidence > best.evidence:
                        best = found
        return best

    def kept(self, sets: Iterable[EffectSubset]) -> list[EffectSubset]:
        """The few best of some sets, each once."""
        unique = {tuple(sorted(m.variant for m in s.members)): s for s in sets}
        return sorted(unique.values(), key=lambda s: -s.evidence)[:MAX_CARRIED_SETS]

    def backward(self, chosen: EffectSubset) -> EffectSubset:
        """Take out members that a better one made superfluous, the weakest first."""
        while chosen.members:
            verified = self.verify(chosen)
            fallen = [v for v in verified if not v.stands]
            if not fallen:
                break
            weakest = min(fallen, key=lambda v: v.evidence)
            chosen = self.polished(
                self.evaluate(m for m in chosen.members if m is not weakest.member)
            )
        return chosen
