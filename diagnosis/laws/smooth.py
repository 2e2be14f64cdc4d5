"""Laws without a formula: curves, alone or times a shape, and surfaces over two variables."""

from collections.abc import Sequence

import numpy as np

from matstd.diagnosis.laws.curves import Waves
from matstd.diagnosis.laws.formulas import Candidate, Part, columns_of, part_of, spread
from matstd.diagnosis.laws.policy import LawPolicy
from matstd.diagnosis.laws.screening import Field, Found, evidence_of, waves_of
from matstd.diagnosis.laws.space import Space
from matstd.diagnosis.residual import Bearer
from matstd.twin.frames import Array
from matstd.twin.laws import (
    ON_BALL,
    SHAPES,
    Driver,
    Factor,
    Law,
    surface_products,
    surface_waves,
)

SURFACE_LENGTHS = (0.05, 0.1, 0.2, 0.4)  # correlation lengths of surfaces, shares of both domains
SURFACES = 4  # products, and pairs of variables that were screened, over which surfaces are tried


def curve_laws(
    space: Space,
    field: Field,
    one: Sequence[Found],
    formulas: Sequence[Candidate],
    policy: LawPolicy,
) -> list[Candidate]:
    """Laws without a formula: the best curves, alone or times a factor that a formula has."""
    out = []
    for f in one:
        if f.length > 0.0:  # else the variable is a direction, or has two values
            score = f.evidence - policy.tried_singles
            own = (f.length, f.size)
            out.append(_curve(field, f.bearer, f.drivers[0], own, f.explained, score))
    products = [c for c in formulas if len(c.law.factors) == 2][:3]
    for c in products:
        for kept, other in ((0, 1), (1, 0)):
            first, driver = part_of(c.law, kept), c.law.factors[other].driver
            waves = waves_of(field, driver)
            if waves.lengths[0] > 0.0:
                C = spread(c.bearer.C, columns_of(field, space, [first]))
                evidence, explained, *size = evidence_of(space, C, waves)
                charge = policy.tried_products + space.charge(len(first.factor.shape.free))
                score = evidence - charge
                out.append(_curve(field, c.bearer, driver, size, explained, score, first))
    return out


def surface_laws(
    space: Space,
    field: Field,
    two: Sequence[Found],
    formulas: Sequence[Candidate],
    policy: LawPolicy,
) -> list[Candidate]:
    """Laws without a formula over two variables that do not separate: a ring, a diagonal.

    Pairs of readings come from the screening and from the best products, since a screened surface
    has few waves. Carriers have one number: three directions of the standard would have 387
    coefficients. No variable is a temperature, which follows the time: such a surface was learnt
    for a law of the time.
    """
    ranked = sorted(formulas, key=lambda c: -c.score)
    products = [(c.bearer, c.law.drivers) for c in ranked if len(c.law.drivers) == 2]
    tried = [*products[:SURFACES], *((f.bearer, f.drivers) for f in two[:SURFACES])]
    each = {
        (bearer.carrier.name, *sorted(d.name for d in drivers)): (bearer, drivers)
        for bearer, drivers in tried
        if bearer.carrier.count == 1
        and all(d.nature in ("linear", "rotary") and d.name not in ON_BALL for d in drivers)
        and all(waves_of(field, d).lengths[0] > 0.0 for d in drivers)
    }
    out = list[Candidate]()
    for bearer, drivers in each.values():
        evidence, explained, places = _surface(space, field, bearer.C, drivers)
        factors = tuple(Factor(SHAPES["surface"], d) for d in drivers)
        law = Law(bearer.carrier, factors, places)
        score = evidence - policy.tried_products
        out.append(
            Candidate(
                bearer=bearer,
                law=law,
                explained=explained,
                parameters=len(law.parameters),
                score=score,
            )
        )
    return out


def _curve(
    field: Field,
    bearer: Bearer,
    driver: Driver,
    size: Sequence[float],
    explained: float,
    score: float,
    *first: Part,
) -> Candidate:
    """A smooth curve over a variable, without a formula, where wanted times a first factor.

    Args:
        size: Its correlation length, as a share of the domain, and its size, mm or rad.
    """
    curve = Part(Factor(SHAPES["curve"], driver), (*field.domain(driver), *size))
    factors, places = zip(*first, curve, strict=True)
    law = Law(bearer.carrier, factors, tuple(v for own in places for v in own))
    return Candidate(
        bearer=bearer, law=law, explained=explained, parameters=len(law.parameters), score=score
    )


def _surface(
    space: Space, field: Field, C: Array, drivers: Sequence[Driver]
) -> tuple[float, float, tuple[float, ...]]:
    """Log evidence of a surface at columns of a carrier (N, k), what it explains, and its places.

    The correlation length is the same share of both domains.
    """
    x, y = (field.x[driver.name] for driver in drivers)
    one, other = (field.domain(driver) for driver in drivers)
    B = surface_products(x, y, (one, other))
    weights = np.array([surface_waves(length) for length in SURFACE_LENGTHS])
    waves = Waves(tuple(drivers), B, weights, SURFACE_LENGTHS)
    evidence, explained, length, size = evidence_of(space, C, waves)
    return evidence, explained, (*one, length, size, *other, length, 1.0)
