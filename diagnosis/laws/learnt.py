"""What was learnt from a run: laws with what speaks for them, and what they predict."""

from dataclasses import dataclass, replace
from functools import cached_property
from itertools import product
from math import prod

import numpy as np

from matstd.diagnosis.fit import Fit, averaged
from matstd.diagnosis.laws.acceptance import HeldOut, Refusal
from matstd.diagnosis.laws.beginning import Beginning
from matstd.diagnosis.laws.library import LibraryEffect
from matstd.diagnosis.laws.policy import LawPolicy
from matstd.twin.frames import Array
from matstd.twin.laws import Carrier, Law, law_of
from matstd.twin.library import owner_of
from matstd.twin.model import Effect, columns
from matstd.twin.record import Run

AS_WELL = 1.0
"""Log odds up to which one explanation is as good as another: a bare mention (Kass and Raftery,
Journal of the American Statistical Association 90 (1995) 773-795)."""


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
    charge: float  # these charges: its parameters, and the choice among so many laws
    curve: float  # that of the best law without a formula
    drift: float  # that of a driver which was not recorded but is smooth in time
    # other laws, the nearest first; those within the policy's odds are its class
    rivals: tuple[Rival, ...]
    # the effect of the library that explains most of the same; None without any
    library: LibraryEffect | None = None
    memory: float = -np.inf  # log evidence of noise that remembers in place of the law
    elsewhere: tuple[Carrier, ...] = ()  # of those alike, each kind that differs in other poses

    @property
    def travels(self) -> bool:
        """Whether it belongs to the machine and not to the run that it was learnt from."""
        return self.law.belongs_to == "machine"

    @property
    def is_of_library(self) -> bool:
        """Whether an effect of the library explains the same as well or better."""
        return self.library_odds < AS_WELL

    @property
    def is_behind_library(self) -> bool:
        """Whether an effect of the library explains the same better."""
        return self.library_odds < -AS_WELL

    @property
    def library_odds(self) -> float:
        """Log odds against the best effect of the library; infinite without any."""
        return np.inf if self.library is None else self.score - self.library.score

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
        share a second run was left with 0.62 um instead of 0.69. A law that belongs to its run
        stands alone, since it predicts no other.
        """
        if not self.travels:
            return [(self.law, 1.0)]
        near, seen = [], {self.law.explanation}
        alike = [Rival(replace(self.law, carrier=carrier), 0.0) for carrier in self.elsewhere]
        for rival in (*alike, *self.rivals):
            if rival.log_odds < policy.class_odds and rival.law.explanation not in seen:
                seen.add(rival.law.explanation)
                near.append(rival)
        laws: list[Effect] = [self.law, *(r.law for r in near[: policy.most_members - 1])]
        odds = [0.0, *(max(r.log_odds, 0.0) for r in near[: policy.most_members - 1])]
        if self.library is not None and self.library_odds < policy.class_odds:
            laws.append(self.library.effect)
            odds.append(self.library_odds)
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
    policy: LawPolicy  # thresholds of the search
    # effects of the library in whose place the laws stand, since they explain the run better; empty
    # where the laws stand beside every effect of the model
    instead_of: tuple[Effect, ...] = ()
    instead_odds: float = 0.0  # log odds for the laws in their place

    @property
    def before(self) -> Fit:
        """The fit without laws."""
        return self.beginning.fit

    @property
    def of_library(self) -> list[str]:
        """Effects of the library that explain as well or better what every law does, by name.

        Empty where a law explains more than any of them: it then stands in the headline.
        """
        named = [one.library.effect.name for one in self.laws if one.library and one.is_of_library]
        return list(dict.fromkeys(named)) if len(named) == len(self.laws) else []

    @property
    def effect_names(self) -> list[str]:
        """First words of the laws as effects of the user's own, until they get better ones."""
        count = len(self.laws)
        return ["learnt-law" if count == 1 else f"learnt-law-{i}" for i in range(1, count + 1)]

    @cached_property
    def _sets(self) -> list[tuple[float, list[Effect]]]:
        """Sets of laws that the run does not distinguish, those chosen first, with their shares."""
        taken = {one.law.name for one in self.laws}
        classes = []
        for one in self.laws:
            every = one.members(self.policy)
            kept = [(e, share) for e, share in every if e is one.law or e.name not in taken]
            taken |= {effect.name for effect, _ in kept}
            classes.append(kept)
        sets = [(prod(s for _, s in one), [e for e, _ in one]) for one in product(*classes)]
        least = np.exp(-self.policy.class_odds) * max(share for share, _ in sets)
        sets = [one for i, one in enumerate(sets) if not i or one[0] > least]
        whole = sum(share for share, _ in sets)
        return [(share / whole, effects) for share, effects in sets]

    @property
    def shares(self) -> dict[str, float]:
        """Share of predictions of every law, and of every effect instead of one, by name."""
        out: dict[str, float] = {}
        for share, effects in self._sets:
            for effect in effects:
                out[effect.name] = out.get(effect.name, 0.0) + share
        return out

    def predicted(self, run: Run, is_clock_kept: bool = False) -> Array:
        """Deviation that the laws add at the touches of any run, (N,), mm.

        Args:
            is_clock_kept: Whether what drives the laws that belong to their run kept its times;
                else they add nothing to another one.
        """
        fit, out = self.saved, np.zeros(len(run))
        is_kept = is_clock_kept or run.fingerprint == self.before.run.fingerprint
        for effect in fit.model.effects[len(self.before.model.effects) :]:
            if is_kept or owner_of(effect) == "machine":
                out += columns([effect], run.touches) @ fit.theta[fit.of_effect(effect.name)]
        return out

    @cached_property
    def saved(self) -> Fit:
        """What predicts: the average over laws that the run does not distinguish.

        Of every formula it has what is not known beyond the values that its variables had, which no
        touch shows: zero, with wider predictions there.
        """
        if not self.laws:
            return self.after
        used, chosen = self.after.run.touches[self.after.used], [one.law for one in self.laws]
        beyond: dict[str, Effect] = {}
        fits = []
        for share, effects in self._sets:
            fit = self.after
            if effects != chosen:
                fit = self.beginning.fitted(effects, gross=self.after.gross)
            margins = [
                margin
                for law in filter(None, map(law_of, effects))
                if not law.is_curve_alone
                for margin in law.beyond(fit.theta[fit.of_effect(law.name)], used)
            ]
            own = [beyond.setdefault(m.name, m) for m in margins]
            whole = [*effects, *own]
            fits.append((share, self.beginning.fitted(whole, gross=self.after.gross)))
        return averaged(fits)
