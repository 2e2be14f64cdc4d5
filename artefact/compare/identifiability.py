"""What touches on a standard can and cannot determine of a machine, for report and file."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from matstd.artefact.compare.alternatives import (
    Alternative,
    alternatives,
    joined_rows,
    other_setups,
    touches_reached_in,
)
from matstd.artefact.reach import Requests
from matstd.artefact.worth import Criterion, setup_parameters
from matstd.information.criteria import Posterior
from matstd.information.identifiability import (
    Degree,
    EstimableCombination,
    FreedomFamily,
    Identifiability,
    combinations,
    identifiability,
    in_families,
    supported_degrees,
)
from matstd.twin.display import Displayed
from matstd.twin.frames import Array
from matstd.twin.machine import Chain
from matstd.twin.model import Model


@dataclass(frozen=True)
class DeterminedParameter:
    """A parameter whose variance the touches reduce at least tenfold; base units."""

    name: str
    expected: float  # standard deviation before the touches
    u: float  # standard uncertainty after them
    unit: str  # base unit


@dataclass(frozen=True, eq=False, repr=False)
class IdentifiabilityReport(Displayed):
    """What the touches of a design can and cannot determine."""

    touches: int
    model: Model
    # smallest and largest reading of every programmed axis in them, mm or rad
    readings: Mapping[str, tuple[float, float]]
    # rank, condition numbers, freedoms and groups, each freedom with what resolves it
    gauge: Identifiability
    freedoms: tuple[FreedomFamily, ...]  # the freedoms, shapes of the same error together
    # determined combinations of machine errors, the most certain first
    combinations: tuple[EstimableCombination, ...]
    # individually determined machine errors, the most certain first
    alone: tuple[DeterminedParameter, ...]
    # polynomial degree of every component error that the touches support
    degrees: tuple[Degree, ...]
    alternatives: tuple[Alternative, ...]  # benefit of a second stylus length or set-up

    @property
    def chain(self) -> Chain:
        """The machine."""
        return self.model.chain


def identifiability_report(
    criterion: Criterion, requests: Requests, rng: np.random.Generator
) -> IdentifiabilityReport:
    """Report what some touches can determine of the machine."""
    model, touches = criterion.model, criterion.reach.touches(requests)
    W = criterion.whitened(requests)
    more = touches_reached_in(criterion.reach, requests, rng)
    richer = {"more touches at the same table poses": criterion.whitened(more)}
    for name, other in other_setups(criterion).items():
        second = touches_reached_in(other, requests, rng)
        if len(second):
            richer[name] = joined_rows(criterion, requests, second, other).W
    gauge = identifiability(
        W, criterion.prior_sd, model.names, model.parameters, model.chain, richer
    )
    units = [p.unit for _, p in model.parameters]
    setup = setup_parameters(model)
    chain = model.chain
    return IdentifiabilityReport(
        touches=len(requests),
        model=model,
        readings={
            name: (float(touches.reading(name).min()), float(touches.reading(name).max()))
            for name in chain.programmed_axes
        },
        gauge=gauge,
        freedoms=in_families(gauge.freedoms),
        combinations=combinations(W, criterion.prior_sd, units, setup.tolist()),
        alone=_determined_parameters(criterion, W, setup.tolist()),
        degrees=supported_degrees(model, touches, W, criterion.noise),
        alternatives=alternatives(criterion, requests, rng),
    )


def _determined_parameters(
    criterion: Criterion, W: Array, setup: Sequence[int]
) -> tuple[DeterminedParameter, ...]:
    """Individually determined machine errors; parameters of the set-up are left out."""
    known = Posterior(W, criterion.prior_sd, criterion.model.names)
    alone = set(known.alone)
    out = [
        DeterminedParameter(name, float(before), float(after), parameter.unit)
        for p, (name, before, after, (_, parameter)) in enumerate(
            zip(known.names, known.prior_sd, known.sd, criterion.model.parameters, strict=True)
        )
        if name in alone and p not in setup
    ]
    return tuple(sorted(out, key=lambda a: a.u / a.expected))
