"""Laws that a model lacks, learnt from a run one after the other, and what they predict."""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from matstd.diagnosis.fit import Fit
from matstd.diagnosis.laws.beginning import Beginning, log_odds
from matstd.diagnosis.laws.library import LibraryEffect, nearest_of_library
from matstd.diagnosis.laws.policy import POLICY, LawPolicy
from matstd.diagnosis.laws.search import Searched, search_law
from matstd.diagnosis.laws.space import Space
from matstd.diagnosis.policy import POLICY as DIAGNOSIS
from matstd.diagnosis.regression import Memory, left_out, likely_memory
from matstd.twin.compute import one_blas_thread
from matstd.twin.frames import Array
from matstd.twin.laws import Carrier, Law
from matstd.twin.model import Effect, Model, columns
from matstd.twin.record import Run

IntArray = NDArray[np.int64]

MIN_TOUCHES = 30
"""Fewer touches than this leave no law that could be distinguished from another."""

TIME_BLOCKS, PLACE_BLOCKS = 10, 5
"""Blocks of time, and of the range of a variable, that are left out one after the other."""


@dataclass(frozen=True, eq=False)
class Rival:
    """A law beside the chosen one.

    Attributes:
        log_odds: Of the chosen law against it.
    """

    law: Law
    log_odds: float


@dataclass(frozen=True, eq=False)
class LearntLaw:
    """One law with what speaks for it.

    Attributes:
        law: With the parameters of its shapes.
        alike: Carriers that do the same at every touch of this run.
        score: Log evidence that it gains, all charges taken off.
        curve: That of the best law without a formula.
        rivals: Other laws, the nearest first; those within the policy's odds are its class.
        library: The effect of the library that explains most of the same; None without any.
    """

    law: Law
    alike: tuple[Carrier, ...]
    score: float
    curve: float
    rivals: tuple[Rival, ...]
    library: LibraryEffect | None = None

    @property
    def is_in_library(self) -> bool:
        """Whether an effect with a cause explains as much."""
        return self.library is not None and self.library.score > self.score

    @property
    def second_choice(self) -> Rival | None:
        """The nearest law of another carrier or other variables."""
        own = _what(self.law)
        return next((rival for rival in self.rivals if _what(rival.law) != own), None)

    def members(self, policy: LawPolicy) -> list[tuple[Law, float]]:
        """Laws that cannot be distinguished, with their shares of a prediction."""
        near, seen = [], {_what(self.law)}
        for rival in self.rivals:
            if rival.log_odds < policy.class_odds and _what(rival.law) not in seen:
                seen.add(_what(rival.law))
                near.append(rival)
        laws = [self.law, *(r.law for r in near[: policy.most_members - 1])]
        odds = np.array([0.0, *(r.log_odds for r in near[: policy.most_members - 1])])
        shares = np.exp(-np.maximum(odds, 0.0))
        return list(zip(laws, (shares / shares.sum()).tolist(), strict=True))


def _what(law: Law) -> tuple[str, ...]:
    """Carrier and variables: shapes of the same are no other explanation."""
    return (law.carrier.name, *sorted(f.driver.name for f in law.factors))


@dataclass(frozen=True, eq=False)
class HeldOut:
    """Error of touches that were left out, without and with the laws.

    Attributes:
        what: "poses", "times", or a variable whose range was cut into blocks.
        before: Root mean square error with the model alone, mm.
        after: With the laws, mm.
    """

    what: str
    before: float
    after: float


@dataclass(frozen=True, eq=False)
class Learning:
    """What a model lacked, as laws.

    Attributes:
        beginning: The model without laws.
        after: With them; the same where there are none.
        tangent: With the displacements of their parameters besides, which gives uncertainties.
        laws: Those that were learnt, in their order.
        refused: The best law where none was accepted; None where nothing at all was found.
        held_out: Errors of touches left out.
        instead_of: Effects of the library in whose place the laws stand, since they explain the run
            better; empty where the laws stand beside every effect of the model.
        instead_odds: Log odds for the laws in their place.
    """

    beginning: Beginning
    after: Fit
    tangent: Fit
    laws: tuple[LearntLaw, ...]
    refused: LearntLaw | None
    held_out: tuple[HeldOut, ...]
    policy: LawPolicy
    instead_of: tuple[Effect, ...] = ()
    instead_odds: float = 0.0

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
    def members(self) -> tuple[tuple[Effect, Array, float], ...]:
        """Laws over which predictions average, with their amplitudes and shares.

        Amplitudes of a member are those that it has in the place of the law that was chosen.
        """
        out: list[tuple[Effect, Array, float]] = []
        chosen = [one.law for one in self.laws]
        for i, one in enumerate(self.laws):
            for law, share in one.members(self.policy):
                effects = [*chosen[:i], law, *chosen[i + 1 :]]
                fit = self.after if law is one.law else self.beginning.fitted(effects)
                out.append((law, fit.theta[fit.of_effect(law.name)], share))
        return tuple(out)

    def predicted(self, run: Run) -> Array:
        """Deviation that the laws add at the touches of any run, (N,), mm."""
        out = np.zeros(len(run))
        for law, theta, share in self.members:
            out += share * (columns([law], run.touches) @ theta)
        return out

    @property
    def u(self) -> Array:
        """Standard uncertainty of the amplitudes and parameters; see `tangent`."""
        return np.sqrt(np.diag(self.tangent.covariance))


def learn_laws(run: Run, model: Model | None = None, policy: LawPolicy = POLICY) -> Learning:
    """Laws that explain what a model leaves of a run.

    Args:
        model: Machine and effects to begin with; None for the ordinary geometric model.

    Raises:
        NotEnoughData: So few touches that nothing can be said.
    """
    return learn_beside(Beginning.of_run(run, model), policy)


@one_blas_thread()
def learn_beside(start: Beginning, policy: LawPolicy = POLICY) -> Learning:
    """Laws that explain what a fitted model leaves."""
    white = replace(start, memory=None)
    current, refused = start.fit, None
    laws: list[LearntLaw] = []
    for _ in range(policy.most_laws if int(current.used.sum()) >= MIN_TOUCHES else 0):
        searched = search_law(Space.of(current), policy)
        best = _learnt(searched)
        if best is None:
            break
        fit = white.fitted([*(one.law for one in laws), best.law])
        if best.score < policy.min_score or not predicts_better(current, fit, policy):
            refused = best
            break
        learnt = [one.law for one in laws]
        if not _stands_beside_memory(start, learnt, best, (current, fit), policy):
            refused = best
            break
        laws.append(replace(best, library=nearest_of_library(searched.space)))
        current = fit
    learnt = [one.law for one in laws]
    if start.memory is not None and laws:
        start = replace(start, memory=_memory_left(current, start.memory))
        current = start.fitted(learnt, gross=current.gross)
    return Learning(
        beginning=start,
        after=current,
        tangent=start.fitted(learnt, True) if laws else start.fit,
        laws=tuple(laws),
        refused=refused,
        held_out=tuple(_held_out(start.fit, current, learnt)),
        policy=policy,
    )


def _stands_beside_memory(
    start: Beginning,
    laws: Sequence[Law],
    best: LearntLaw,
    white: tuple[Fit, Fit],
    policy: LawPolicy,
) -> bool:
    """Whether a law explains more than noise does that remembers, where there is such noise."""
    if start.memory is None:
        return True
    charged = log_odds(white[1], white[0], 0.0) - best.score
    after = start.fitted([*laws, best.law])
    return log_odds(after, start.fitted(laws, gross=after.gross), charged) > policy.min_score


def _memory_left(fit: Fit, before: Memory) -> Memory | None:
    """What the noise still remembers with the laws in the model; most of it was the laws."""
    memory, gain = likely_memory(fit.run.touches, fit.u, fit.used, fit.X, fit.y)
    if gain < DIAGNOSIS.memory_gain:
        return None
    return replace(memory, is_filtered=before.is_filtered)


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


def predicts_better(before: Fit, after: Fit, policy: LawPolicy) -> bool:
    """Whether touches left out, by poses and by times, are predicted better with a law.

    Freed of the uncertainty of the prediction: where a block takes most of a set-up with it, plain
    errors are those of a set-up that is extrapolated, with and without a law.
    """
    for groups in (pose_groups(before), time_groups(before)):
        was, now = _own_error(before, groups), _own_error(after, _same(groups, after))
        if now > (1.0 - policy.least_gain) * was:
            return False
    return True


def pose_groups(fit: Fit) -> list[IntArray]:
    """Rows of the run, by table pose in every set-up, as the fit has them."""
    rows = np.flatnonzero(fit.used)
    return [rows[g] for g in fit.groups]


def time_groups(fit: Fit) -> list[IntArray]:
    """Rows of the run in blocks one after the other."""
    return list(np.array_split(np.flatnonzero(fit.used), TIME_BLOCKS))


def _same(groups: Sequence[IntArray], after: Fit) -> list[IntArray]:
    """The same blocks of rows, as far as another fit uses them."""
    return [g[after.used[g]] for g in groups]


def _own_error(fit: Fit, groups: Sequence[IntArray]) -> float:
    """Error of rows left out over what their uncertainty explains, in units of the stated noise."""
    inside = _within(fit, groups)
    return left_out(fit.solution.Q, fit.solution.residual, inside).rms * fit.noise.factor


def _within(fit: Fit, groups: Sequence[IntArray]) -> list[IntArray]:
    """Blocks as numbers within the rows that the fit uses."""
    place = np.full(len(fit.used), -1)
    place[fit.used] = np.arange(int(fit.used.sum()))
    inside = [place[g][place[g] >= 0] for g in groups]
    return [g for g in inside if len(g)]


def _error(fit: Fit, groups: Sequence[IntArray]) -> float:
    """Root mean square error of rows left out block by block, mm."""
    inside = _within(fit, groups)
    found = left_out(fit.solution.Q, fit.solution.residual, inside)
    rows = np.concatenate(inside)
    return float(np.sqrt(np.mean((found.error * fit.u[fit.used])[rows] ** 2)))


def _held_out(before: Fit, after: Fit, laws: Sequence[Law]) -> list[HeldOut]:
    """Errors of touches left out: by poses, by times, and by blocks of every variable of a law."""
    blocks = {"poses": pose_groups(before), "times": time_groups(before)}
    touches = before.run.touches
    for driver in dict.fromkeys(f.driver for law in laws for f in law.factors):
        rows = np.flatnonzero(before.used)
        x = driver.values(touches)[rows]
        if len(np.unique(x)) > PLACE_BLOCKS:
            order = rows[np.argsort(x, kind="stable")]
            blocks[driver.name] = list(np.array_split(order, PLACE_BLOCKS))
    return [
        HeldOut(what, _error(before, groups), _error(after, _same(groups, after)))
        for what, groups in blocks.items()
    ]
