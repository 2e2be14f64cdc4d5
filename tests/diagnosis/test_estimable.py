"""What a run determines and what it never shows: named, and with uncertainties that hold."""

from dataclasses import replace

import numpy as np
import pytest

from matstd.diagnosis.fit import estimable, fit_run
from matstd.twin.model import columns
from matstd.twin.units import NM

MACHINES = 20
BINOMIAL = 4.0
"""A share off by more than so many of its standard deviations has a probability of 6e-5."""


@pytest.fixture(scope="module")
def known(fitted):
    fit = fitted(1, "hsm600u")
    return fit, estimable(fit)


def test_what_a_spindle_that_stands_still_hides_is_named(known) -> None:
    """Without turning, the line of C1 runs through the ball: moving or turning it shows nothing."""
    _, e = known
    alone = {f.parameter for f in e.freedoms if not f.alike}
    assert {f"location({s}0C1)" for s in ("EX", "EY", "EA", "EB", "EC")} <= alone
    assert "geometric(ECZ,linear)" in alone  # turns about the line from spindle to ball


def test_constant_of_c_is_the_rotation_of_the_set_ups(known) -> None:
    """A zero of C that is off looks like standards that were all turned on the table."""
    _, e = known
    turns = {f"setup({c}): rz" for c in "abc"}
    freedom = next(f for f in e.freedoms if turns <= {f.parameter, *f.values})
    weights = {freedom.parameter: -1.0, **freedom.values}
    assert {"location(EC0C)", *turns} <= set(weights)
    for turn in turns:  # as many rad as C itself
        assert abs(weights[turn]) == pytest.approx(abs(weights["location(EC0C)"]), abs=1e-6)
    assert len({np.sign(weights[turn]) for turn in turns}) == 1
    assert "location(EC0C)" not in {d.name for d in e.determined}


def test_no_touch_notices_a_gauge(known) -> None:
    """Every named freedom, tried on the columns: 10 um or urad of the leading parameter."""
    fit, e = known
    A = columns(fit.effects, fit.run.touches)
    place = {name: i for i, name in enumerate(fit.names)}
    assert e.found.parameters == len(fit.names)
    assert e.found.rank + len(e.freedoms) == e.found.parameters
    for freedom in e.freedoms:
        lead = place[freedom.parameter]
        scale = 0.01 if fit.parameters[lead][1].unit == "mm" else 1e-5
        theta = np.zeros(len(fit.names))
        theta[lead] = scale
        for name, per_unit in freedom.values.items():  # what imitates it, taken back
            theta[place[name]] = -scale * per_unit
        # singular vectors are exact to rounding times the condition of some 1e5
        assert np.max(np.abs(A @ theta)) < 0.1 * NM, freedom


def test_rank_is_that_of_the_columns(known) -> None:
    fit, e = known
    A = columns(fit.effects, fit.run.touches)
    size = np.linalg.norm(A, axis=0)
    seen = size > 1e-9 * size.max()  # the rest is rounding
    assert e.found.rank == np.linalg.matrix_rank(A[:, seen] / size[seen], tol=1e-6)


def test_determined_parameters_are_freed_of_their_prior(known) -> None:
    fit, e = known
    assert e.determined
    for d in e.determined:
        assert d.u < d.prior_sd / 10.0
        column = columns(fit.effects, fit.run.touches)[:, fit.names.index(d.name)]
        assert d.u >= 0.999 / np.linalg.norm(
            column / fit.u
        )  # never better than if all else is known


@pytest.mark.slow
def test_stated_uncertainties_hold_over_random_machines(known) -> None:
    """Machines from the prior, noise as stated: errors over their uncertainty are standard normal.

    The combinations of one machine are independent by construction, so all of them are counted.
    """
    base, e = known
    run = base.run
    A = columns(base.effects, run.touches)
    machine = len(base.model.parameters)
    sd = np.array([p.sd for effect in base.effects for p in effect.parameters])
    rng = np.random.default_rng(12)
    inside = total = determined_inside = determined_total = 0
    for _ in range(MACHINES):
        theta = sd * rng.normal(size=len(sd))
        theta[machine:] *= 0.01  # a standard is never clamped a millimetre off
        fit = fit_run(replace(run, deviation=A @ theta + rng.normal(0.0, run.u)), base.model)
        found = estimable(fit)
        for c in found.combinations:
            inside += abs(c.value - c.weights @ theta) < 1.96 * c.u
            total += 1
        for d in found.determined:
            place = fit.names.index(d.name)
            determined_inside += abs(d.value - theta[place]) < 1.96 * d.u
            determined_total += 1
    assert total > 30 * MACHINES
    assert inside / total == pytest.approx(0.95, abs=BINOMIAL * np.sqrt(0.95 * 0.05 / total))
    # parameters of one machine share their errors: only machines count as independent
    allowed = BINOMIAL * np.sqrt(0.95 * 0.05 / MACHINES / 4)
    assert determined_inside / determined_total == pytest.approx(0.95, abs=allowed)
    assert len(e.combinations) > 30
