"""What was learnt from a run: laws with what speaks for them, and what they predict."""

from dataclasses import dataclass
from functools import cached_property

import numpy as np

from matstd.diagnosis.fit import Fit
from matstd.diagnosis.laws.acceptance import HeldOut, Refusal
from matstd.diagnosis.laws.beginning import Beginning
from matstd.diagnosis.laws.library import LibraryEffect
from matstd.diagnosis.laws.policy import LawPolicy
from matstd.twin.frames import Array
from matstd.twin.laws import Carrier, Law
from matstd.twin.library import owner_of
from matstd.twin.model import Effect, columns
from matstd.twin.record import Run


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

    def members(self, policy: LawPolicy) -> list[tuple[Effect, float]]:
        """Laws that cannot be distinguished, with their shares of a prediction.

        An effect of the library that explains as well is one of them: it has a cause, and with its
        share a second run was left with 0.62 um instead of 0.69.
        """
        near, seen = [], {self.law.explanation}
        for rival in self.rivals:
            if rival.log_odds < policy.class_odds and rival.law.explanation not in seen:
                seen.add(rival.law.explanation)
                near.append(rival)
        laws: list[Effect] = [self.law, *(r.law for r in near[: policy.most_members - 1])]
        odds = [0.0, *(max(r.log_odds, 0.0) for r in near[: policy.most_members - 1])]
        if self.library is not None and self.score - self.library.score < policy.class_odds:
            laws.append(self.library.effect)
            odds.append(self.score - self.library.score)
        shares = np.exp(-np.array(odds))
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
