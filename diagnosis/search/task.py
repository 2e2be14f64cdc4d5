"""What is diagnosed: a run, the starting model, and what is believed of both."""

from collections.abc import Sequence
from dataclasses import dataclass, replace

from matstd.diagnosis.evidence import RawColumns, ResidualSpace, ScaledEffect
from matstd.diagnosis.fit import Fit, Prior, fit_run, prior_for
from matstd.diagnosis.regression import GrossErrors, Memory
from matstd.twin.model import Model
from matstd.twin.record import Run

FOUND_PRIOR_FACTOR = 3.0
"""Factor on the prior of a found effect in its last fit. Being found indicates its size better than
the usual size, and the estimate must not be drawn to zero."""


@dataclass(frozen=True, slots=True, eq=False)
class DiagnosisTask:
    """What is diagnosed: a run, the starting model, and what is believed of it."""

    run: Run
    model: Model
    prior: Prior
    is_known: bool = False  # whether the prior is an earlier fit, rather than what is usual
    memory: Memory | None = None  # of the noise; None for white noise
    # prior of the starting model by itself, where `prior` is what suits it beside effects
    alone: Prior | None = None
    # of effects at its touches, for all projections of the diagnosis; None keeps none
    raw: RawColumns | None = None
    added: tuple[ScaledEffect, ...] = ()  # what the user added: in every set that is searched

    def space(self, fit: Fit) -> ResidualSpace:
        """What a fit of this run leaves."""
        return ResidualSpace.of(fit, self.raw)

    def fit(
        self,
        effects: Sequence[ScaledEffect] = (),
        gross: GrossErrors | None = None,
        beside: Fit | None = None,
    ) -> Fit:
        """The model with further effects, fitted; `gross` and `beside` as in `fit_run`."""
        model = Model(self.model.chain, (*self.model.effects, *(s.effect for s in effects)))
        prior = self.prior if effects or self.alone is None else self.alone
        for sized in effects:
            prior = prior.joined(self.found_prior(sized))
        return fit_run(self.run, model, prior, None, gross, self.memory, beside)

    def fit_found(
        self,
        effects: Sequence[ScaledEffect] = (),
        gross: GrossErrors | None = None,
        beside: Fit | None = None,
    ) -> Fit:
        """The same of effects that were found, beside those that the user added."""
        return self.fit((*self.added, *effects), gross, beside)

    def suited(self, effects: Sequence[ScaledEffect]) -> "DiagnosisTask":
        """The same with the prior that suits the machine once found effects are in the model.

        What an effect does, errors of the machine seem to do as long as it is missing.
        """
        effects = (*self.added, *effects)
        if self.is_known or not effects:
            return self
        model = Model(self.model.chain, (*self.model.effects, *(s.effect for s in effects)))
        stated = Prior.of_effects(self.model.effects)
        for sized in effects:
            stated = stated.joined(self.found_prior(sized))
        found = prior_for(self.run, model, None, self.memory, stated)
        own = slice(len(self.prior))
        narrowed = None if found.narrowed is None else found.narrowed[own]
        prior = Prior(found.mean[own], found.root[own, own], narrowed)
        return replace(self, prior=prior, alone=self.prior)

    def found_prior(self, sized: ScaledEffect) -> Prior:
        """Of the parameters of an effect that was added."""
        return Prior.of_effects([sized.effect]).widened(FOUND_PRIOR_FACTOR * sized.scale)
