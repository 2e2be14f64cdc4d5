"""What a run determines: combinations of parameters, single parameters, and what it never shows."""

from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np

from matstd.diagnosis.fit.identification import Fit
from matstd.information.identifiability import (
    EstimableCombination,
    Freedom,
    Identifiability,
    combinations,
    identifiability,
)
from matstd.twin.frames import Array
from matstd.twin.model import columns

MIN_DETERMINED_GAIN = 10.0
"""A parameter counts as determined when the run cuts its standard deviation by this factor."""


@dataclass(frozen=True, slots=True)
class Determined:
    """A parameter that the run determines alone; base units."""

    name: str
    value: float
    u: float
    prior_sd: float
    unit: str


@dataclass(frozen=True, eq=False)
class Estimable:
    """What a fit can and cannot say."""

    fit: Fit
    # columns of the touches in use over their noise, times the prior's standard deviations
    rows: Array
    effective: float  # number of parameters that the data rather than the prior decide
    # combinations of the machine's parameters, best determined first
    combinations: tuple[EstimableCombination, ...]
    determined: tuple[Determined, ...]  # parameters that are determined by themselves, best first

    @cached_property
    def found(self) -> Identifiability:
        """Rank, condition and gauge freedoms of the touches in use, without any prior."""
        fit = self.fit
        expected, chain = fit.prior.expected, fit.model.chain
        return identifiability(self.rows, expected, fit.names, fit.parameters, chain)

    @property
    def freedoms(self) -> tuple[Freedom, ...]:
        """What no touch of this run shows; the prior keeps it near its mean."""
        return self.found.freedoms


def estimable(fit: Fit) -> Estimable:
    """Eigen-directions of posterior against prior, single parameters, and gauge freedoms.

    The combinations are those of the machine, with the set-ups of the standard free: rows are first
    freed of what a set-up can imitate.

    Args:
        fit: Its rows in use count, and the standard deviations expected of the class of machine.
    """
    W = columns(fit.effects, fit.run.touches)[fit.used] * fit.prior.expected
    W /= fit.u[fit.used, None]
    return Estimable(
        fit=fit,
        rows=W,
        effective=fit.solution.effective_parameters,
        combinations=_combinations(fit, W),
        determined=_determined(fit),
    )


def _combinations(fit: Fit, W: Array) -> tuple[EstimableCombination, ...]:
    """Combinations of the machine's parameters with their values in this fit."""
    free = range(len(fit.model.parameters), len(fit.prior))
    units = [p.unit for _, p in fit.parameters]
    return tuple(
        replace(
            c,
            value=float(c.weights @ fit.theta),
            u=float(np.linalg.norm(fit.spread.T @ c.weights)),
        )
        for c in combinations(W, fit.prior.expected, units, free)
    )


def _determined(fit: Fit) -> tuple[Determined, ...]:
    """Single parameters whose uncertainty the run cuts tenfold, the most certain first."""
    sd, u, theta = fit.prior.sd, np.sqrt(np.diag(fit.covariance)), fit.theta
    order = [k for k in np.argsort(u / sd) if u[k] * MIN_DETERMINED_GAIN < sd[k]]
    return tuple(
        Determined(
            name=fit.names[k],
            value=float(theta[k]),
            u=float(u[k]),
            prior_sd=float(sd[k]),
            unit=fit.parameters[k][1].unit,
        )
        for k in order
    )
