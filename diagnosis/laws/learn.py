"""Laws that a model lacks, learnt from a run one after the other, and what they predict."""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np

from matstd.diagnosis.fit import Fit
from matstd.diagnosis.laws.acceptance import (
    HeldOut,
    Refusal,
    held_out,
    holds_between,
    memory_left,
    memory_score,
    predicts_better,
    stands_beside_memory,
)
from matstd.diagnosis.laws.beginning import Beginning, log_odds
from matstd.diagnosis.laws.library import LibraryEffect, nearest_of_library
from matstd.diagnosis.laws.policy import POLICY, LawPolicy
from matstd.diagnosis.laws.search import Ground, Searched, search_law
from matstd.diagnosis.laws.space import Space
from matstd.twin.compute import one_blas_thread
from matstd.twin.frames import Array
from matstd.twin.laws import Carrier, Law
from matstd.twin.library import owner_of
from matstd.twin.model import Effect, Model, columns
from matstd.twin.record import Run, Touches

MIN_TOUCHES_OF_LAW = 30
"""Fewer touches than this leave no law that could be distinguished from another."""


STAND_IN = ("level", "time")
"""Natures of variables that may stand for a driver that was not recorded: what was commanded, a
reading or a direction, does not."""

PROPORTIONAL = ("lin", "lin-from")
"""Shapes that are taken for what they say, since bodies expand in proportion to a temperature."""


@dataclass(frozen=True, eq=False)
class Rival:
    """A law beside the chosen one."""

    law: Law
    log_odds: float  # of the chosen law against it


@dataclass(frozen=True, eq=False)
class LearntLaw:
    """One law with what speaks for it."""

    law: Law  # with the parameters of its shapes
    alike: tuple[Carrier, ...]  # carriers that do the same at every touch of this run
    score: float  # log evidence that it gains, all charges taken off
    curve: float  # that of the best law without a formula
    drift: float  # that of a driver which was not recorded but is smooth in time
    # other laws, the nearest first; those within the policy's odds are its class
    rivals: tuple[Rival, ...]
    # the effect of the library that explains most of the same; None without any
    library: LibraryEffect | None = None
    memory: float = -np.inf  # log evidence of noise that remembers in the place of the law

    @property
    def is_in_library(self) -> bool:
        """Whether an effect with a cause explains as much."""
        return self.library is not None and self.library.score > self.score

    @property
    def travels(self) -> bool:
        """Whether it belongs to the machine and not to the run that it was learnt from."""
        return self.law.belongs_to == "machine"

    @property
    def run_odds(self) -> float:
        """Log odds against the nearest of all laws that belong to the run alone."""
        near = (r.log_odds for r in self.rivals if r.law.belongs_to == "run")
        return min(self.score - self.drift, *near, np.inf)

    @property
    def second_choice(self) -> Rival | None:
        """The nearest law of another carrier or other variables."""
        own = self.law.explanation
        return next((rival for rival in self.rivals if rival.law.explanation != own), None)

    def members(self, policy: LawPolicy) -> list[tuple[Law, float]]:
        """Laws that cannot be distinguished, with their shares of a prediction."""
        near, seen = [], {self.law.explanation}
        for rival in self.rivals:
            if rival.log_odds < policy.class_odds and rival.law.explanation not in seen:
                seen.add(rival.law.explanation)
                near.append(rival)
        laws = [self.law, *(r.law for r in near[: policy.most_members - 1])]
        odds = np.array([0.0, *(r.log_odds for r in near[: policy.most_members - 1])])
        shares = np.exp(-np.maximum(odds, 0.0))
        return list(zip(laws, (shares / shares.sum()).tolist(), strict=True))


@dataclass(frozen=True, eq=False)
class Learning:
    """What a model lacked, as laws."""

    beginning: Beginning  # the model without laws
    after: Fit  # with them; the same where there are none
    tangent: Fit  # with the displacements of their parameters besides, which gives uncertainties
    laws: tuple[LearntLaw, ...]  # those that were learnt, in their order
    # the first law that was not kept; None where nothing at all was found
    refused: LearntLaw | None
    refusal: Refusal | None  # why it was not
    held_out: tuple[HeldOut, ...]  # errors of touches left out
    policy: LawPolicy
    # effects of the library in whose place the laws stand, since they explain the run better; empty
    # where the laws stand beside every effect of the model
    instead_of: tuple[Effect, ...] = ()
    instead_odds: float = 0.0  # log odds for the laws in their place

    @property
    def before(self) -> Fit:
        """The fit without laws."""
        return self.beginning.fit

    @property
    def effect_names(self) -> list[str]:
        """First words of the laws as effects of the user's own, until they get better ones."""
        count = len(self.laws)
        return ["learnt-law" if count == 1 else f"learnt-law-{i}" for i in range(1, count + 1)]

    @cached_property
    def members(self) -> dict[str, list[tuple[Effect, Array, float]]]:
        """Laws over which predictions average, with amplitudes and shares, by the law chosen.

        Amplitudes of a member are those that it has in the place of the law that was chosen.
        """
        out: dict[str, list[tuple[Effect, Array, float]]] = {}
        chosen = [one.law for one in self.laws]
        for i, one in enumerate(self.laws):
            own = out.setdefault(one.law.name, [])
            for law, share in one.members(self.policy):
                effects = [*chosen[:i], law, *chosen[i + 1 :]]
                fit = self.after if law is one.law else self.beginning.fitted(effects)
                own.append((law, fit.theta[fit.of_effect(law.name)], share))
        return out

    def predicted(self, run: Run) -> Array:
        """Deviation that the laws add at the touches of any run, (N,), mm.

        A law that belongs to the run that it was learnt from adds nothing elsewhere.
        """
        return self._added(run, run.fingerprint == self.before.run.fingerprint)

    def predicted_by_clock(self, run: Run) -> Array:
        """The same, if what drives laws of the time kept the times of its run in another."""
        return self._added(run, True)

    def _added(self, run: Run, is_clock_kept: bool) -> Array:
        out = np.zeros(len(run))
        for one in self.laws:
            for law, theta, share in self.members[one.law.name]:
                if is_clock_kept or (one.travels and owner_of(law) == "machine"):
                    out += share * (columns([law], run.touches) @ theta)
        return out

    @cached_property
    def saved(self) -> Fit:
        """With what is not known of every formula beyond the values that its variables had.

        No touch shows that: the estimates are those of `after`, with wider predictions elsewhere.
        """
        used = self.after.run.touches[self.after.used]
        beyond: dict[str, Effect] = {}
        for one in (one.law for one in self.laws if not one.law.is_curve_alone):
            theta = self.after.theta[self.after.of_effect(one.name)]
            beyond |= {law.name: law for law in one.beyond(theta, used)}
        laws = [one.law for one in self.laws]
        if not beyond:
            return self.after
        return self.beginning.fitted([*laws, *beyond.values()], gross=self.after.gross)

    @property
    def u(self) -> Array:
        """Standard uncertainty of the amplitudes and parameters; see `tangent`."""
        return np.sqrt(np.diag(self.tangent.covariance))


@one_blas_thread()
def learn_laws(run: Run, model: Model | None = None, policy: LawPolicy = POLICY) -> Learning:
    """Laws that explain what a model leaves of a run.

    Args:
        model: Machine and effects to begin with; None for the ordinary geometric model.

    Raises:
        NotEnoughData: So few touches that nothing can be said.
    """
    return learn_beside(Beginning.of_run(run, model), policy)


@one_blas_thread()
def learn_beside(
    start: Beginning,
    policy: LawPolicy = POLICY,
    is_searched: bool = False,
    ground: Ground | None = None,
) -> Learning:
    """Laws that explain what a fitted model leaves.

    Args:
        is_searched: Whether effects of the library were looked for before: then one that comes near
            a law takes nothing from it.
        ground: Of another search in the same run.
    """
    white = replace(start, memory=None)
    ground = ground or Ground.of(start.run)
    current, refused = start.fit, None
    laws: list[LearntLaw] = []
    charges: list[float] = []
    is_enough = int(current.used.sum()) >= MIN_TOUCHES_OF_LAW
    refusal = None if is_enough else Refusal.FEW
    for _ in range(policy.most_laws if is_enough else 0):
        searched = search_law(Space.of(current), ground, policy)
        best = _learnt(searched)
        if best is None:
            break
        learnt = [one.law for one in laws]
        fit = white.fitted([*learnt, best.law])
        refusal = _refusal(start, learnt, best, (current, fit), policy)
        if refusal is None:
            best = replace(
                best, library=nearest_of_library(searched.space), memory=memory_score(current)
            )
            refusal = _by_rival(best, is_searched)
        if refusal is not None:
            refused = best
            break
        laws.append(best)
        charges.append(log_odds(fit, current, best.score))
        current = _each_anew(white, laws, charges, fit, policy, ground)
    if laws:
        seen = start.run.touches[current.used]
        laws = [_of_its_run(one, seen, policy) for one in laws]
        current = white.fitted([one.law for one in laws], gross=current.gross)
    learnt = [one.law for one in laws]
    if start.memory is not None and laws:
        start = replace(start, memory=memory_left(current, start.memory))
        current = start.fitted(learnt, gross=current.gross)
    return Learning(
        beginning=start,
        after=current,
        tangent=start.fitted(learnt, True) if laws else start.fit,
        laws=tuple(laws),
        refused=refused,
        refusal=refusal,
        held_out=tuple(held_out(start.fit, current, learnt)),
        policy=policy,
    )


def _of_its_run(one: LearntLaw, seen: Touches, policy: LawPolicy) -> LearntLaw:
    """The law, with what belongs to its run marked among its rivals and itself.

    A law over a temperature or a level may stand for a driver that was not recorded, which another
    run meets at another temperature.

    Args:
        seen: Touches from which it was learnt.
    """
    rivals = [replace(r, law=replace(r.law, is_of_run=not r.law.rests(seen))) for r in one.rivals]
    one = replace(one, rivals=tuple(rivals))
    is_stand_in = any(
        f.driver.nature in STAND_IN and f.shape.word not in PROPORTIONAL for f in one.law.factors
    )
    is_open = is_stand_in and one.run_odds < policy.open_driver
    is_of_run = is_open or not one.law.rests(seen)
    return replace(one, law=replace(one.law, is_of_run=is_of_run))


def _each_anew(
    white: Beginning,
    laws: list[LearntLaw],
    charges: list[float],
    fit: Fit,
    policy: LawPolicy,
    ground: Ground,
) -> Fit:
    """Every law searched anew with the others in place, until none of them changes.

    The first of several laws is found while the others are part of the noise, and may hold a part
    of them. Another law takes its place where it explains the run better, all charges taken off.

    Args:
        laws: Those that were learnt; the last one with all others in place. Changed in place.
        charges: What each was charged; changed with them.
        fit: With all of them.
    """
    waiting = set(range(len(laws) - 1))
    for _ in range(policy.most_turns * len(laws)):
        if not waiting:
            break
        i = min(waiting)
        waiting.remove(i)
        others = set(range(len(laws))) - {i}
        base = white.fitted([laws[k].law for k in sorted(others)])
        best = _learnt(search_law(Space.of(base), ground, policy))
        if best is None or best.score < policy.min_score:
            continue
        is_same = best.law.name == laws[i].law.name
        margin = 0.0 if is_same else policy.shorter
        if best.score < log_odds(fit, base, charges[i]) + margin:
            continue
        laws[i] = replace(best, library=laws[i].library, memory=laws[i].memory)
        fit = white.fitted([one.law for one in laws])
        charges[i] = log_odds(fit, base, best.score)
        waiting |= set() if is_same else others
    return fit


def _refusal(
    start: Beginning,
    laws: Sequence[Law],
    best: LearntLaw,
    white: tuple[Fit, Fit],
    policy: LawPolicy,
) -> Refusal | None:
    """Why a law is not kept beside others; None where it predicts and is beyond chance.

    Args:
        white: Fits without and with the law, in white noise.
    """
    if best.score < policy.min_score:
        return Refusal.CHANCE
    if not predicts_better(*white) or not holds_between(*white, best.law):
        return Refusal.PREDICTION
    if not stands_beside_memory(start, laws, best.law, best.score, white, policy):
        return Refusal.MEMORY
    return None


def _by_rival(best: LearntLaw, is_searched: bool) -> Refusal | None:
    """Which rival of another kind explains more than a law; None for none."""
    if best.memory > best.score:
        return Refusal.MEMORY
    return Refusal.LIBRARY if best.is_in_library and not is_searched else None


def _learnt(searched: Searched) -> LearntLaw | None:
    """The choice of a search with its rivals; None where there is no candidate."""
    if not searched.candidates:
        return None
    first = searched.candidates[0]
    law = replace(first.law, carrier=_usual(first.law, first.bearer.alike))
    alike = [c for c in (first.bearer.carrier, *first.bearer.alike) if c.name != law.carrier.name]
    rivals = [
        Rival(replace(c.law, carrier=_usual(c.law, c.bearer.alike)), first.score - c.score)
        for c in searched.candidates[1:]
    ]
    return LearntLaw(
        law=law,
        alike=tuple(alike),
        score=first.score,
        curve=searched.curve,
        drift=searched.drift,
        rivals=tuple(sorted(rivals, key=lambda r: r.log_odds)),
    )


def _usual(law: Law, alike: Sequence[Carrier]) -> Carrier:
    """Of carriers that do the same that of the axis which the law is a function of."""
    axes = [f.driver.name for f in law.factors]
    for axis in axes:
        for carrier in (law.carrier, *alike):
            symbol = carrier.symbol
            if symbol is not None and symbol.link == axis and not symbol.is_angular:
                return carrier
    return law.carrier
