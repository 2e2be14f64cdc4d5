"""What laws are learnt beside: a fitted model, and how it is fitted anew with laws in it."""

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from matstd.diagnosis.fit import Fit, Prior, fit_run, prior_for
from matstd.diagnosis.laws.space import Space
from matstd.diagnosis.regression import GrossErrors, Memory
from matstd.twin.library import ordinary_model
from matstd.twin.model import Effect, Model
from matstd.twin.record import Run, with_commanded, without_copies


@dataclass(frozen=True, eq=False)
class Beginning:
    """A model without laws, as it fits a run."""

    fit: Fit  # in white noise: columns of laws are scanned row by row
    prior: Prior | None = None  # of the parameters of its model; None for what its effects state
    is_known: bool = False  # whether that prior is an earlier fit, which this run does not narrow
    memory: Memory | None = None  # of the noise as it was found without laws; None for white noise

    @classmethod
    def of_run(cls, run: Run, model: Model | None = None) -> "Beginning":
        """A run with a model, None for the ordinary one; raises NotEnoughData."""
        run = with_commanded(without_copies(run))
        return cls(fit_run(run, model or ordinary_model(run.touches.chain)))

    @classmethod
    def of_fit(cls, fit: Fit, base: Model, known: Prior | None = None) -> "Beginning":
        """The last fit of a diagnosis.

        Args:
            base: Its starting model: effects that it has besides keep the prior they were given.
            known: What was known of the starting model from another run.
        """
        first = len(base.parameters)
        own = slice(first, len(fit.model.parameters))
        found = Prior(fit.prior.mean[own], fit.prior.root[own, own])
        prior = (known or Prior.of_effects(base.effects)).joined(found)
        start = cls(fit, prior, known is not None)
        if fit.memory is None:
            return start
        # laws are scanned in white noise, and must then explain more than a memory does
        return replace(start, fit=start.fitted(()), memory=fit.memory)

    @property
    def run(self) -> Run:
        """The measurements."""
        return self.fit.run

    def fitted(
        self,
        laws: Sequence[Effect],
        with_tangents: bool = False,
        gross: GrossErrors | None = None,
    ) -> Fit:
        """The model with laws in it; gross errors are looked for anew unless they are given."""
        run, start = self.run, self.fit.model
        model = Model(start.chain, (*start.effects, *laws))
        prior = None
        if self.prior is not None:
            prior = self.prior.joined(Prior.of_effects(laws))
            prior = prior if self.is_known else prior_for(run, model, gross, self.memory, prior)
        fit = fit_run(run, model, prior, None, gross, self.memory)
        if not with_tangents:
            return fit
        theta = fit.theta[: len(model.parameters)]
        return fit_run(run, model, prior, theta, fit.gross, self.memory)


def log_odds(one: Fit, other: Fit, charged: float) -> float:
    """Log odds of one model against another, by what they leave of the same rows.

    Args:
        charged: What the first is charged more than the second.
    """
    left = Space.of(other)
    return float(left.gained(np.array(left.square - Space.of(one).square))) - charged
