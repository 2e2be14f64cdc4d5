"""Correlated errors: what is asked for is drawn, and the closed covariances know of it."""

import numpy as np
import pytest
from machines import none_but

from matstd.sensitivity.first_order import covariance, latin_hypercube, rms, variance_parts
from matstd.sensitivity.montecarlo.random_machines import first_order
from matstd.sensitivity.population import (
    Dependence,
    Distributions,
    Group,
    Mix,
    Population,
    coefficients,
    draw,
    drawn_errors,
    grouped,
    product_moment,
)
from matstd.sensitivity.population.dependence import amplitude
from matstd.twin.effects import ComponentError
from matstd.twin.errors import DesignError

LENGTH = 160.0
NAMES = ("EXX", "EYX", "EC0Y")
R = np.array([[1.0, 0.6, -0.3], [0.6, 1.0, 0.2], [-0.3, 0.2, 1.0]])
RANGES = {"EXX": (0.05, 0.1), "EYX": (0.0, 0.08), "EC0Y": (1e-4, 3e-4)}


def only(chain, ranges=RANGES, **other):
    return Population(chain, none_but(**ranges), **other)


def column(chain, name):
    return next(p for p, s in enumerate(chain.symbols) if s.name == name)


@pytest.mark.parametrize("rho", [-1.0, -0.7, 0.0, 0.4, 0.95, 1.0])
def test_product_moment_is_that_of_an_integral(rho):
    # Gauss-Hermite in the common part, exact conditional means of the other part by fine sampling
    low, high = np.array([0.3, 0.0]), np.array([1.0, 2.0])
    z = np.linspace(-8.0, 8.0, 4001)
    weight = np.exp(-0.5 * z * z)
    weight /= weight.sum()
    a = amplitude(z, low[0], high[0])
    y = rho * z[:, None] + np.sqrt(1.0 - rho**2) * z[None, ::8]
    inner = weight[::8] / weight[::8].sum()
    b = amplitude(y, low[1], high[1]) @ inner
    found = product_moment(np.full((2, 2), rho), low, high)[0, 1]
    assert found == pytest.approx((weight * a) @ b, abs=1e-3)


def test_amplitudes_have_the_correlations_asked_for(chain):
    population = only(chain, dependence=Dependence(NAMES, R))
    draws = draw(population, 60_000, np.random.default_rng(1))
    some = [column(chain, name) for name in NAMES]
    found = np.corrcoef(draws.amplitude[:, some].T)
    # standard error of a correlation by 60 000 draws: 0.004
    np.testing.assert_allclose(found, R, atol=0.016)
    for name, p in zip(NAMES, some, strict=True):
        low, high = RANGES[name]
        size = np.abs(draws.amplitude[:, p])
        assert low <= size.min()
        assert size.max() <= high
        np.testing.assert_allclose(
            np.quantile(size, (0.25, 0.5, 0.75)),
            low + (high - low) * np.array([0.25, 0.5, 0.75]),
            rtol=0.03,
        )
        assert np.mean(draws.amplitude[:, p] > 0.0) == pytest.approx(0.5, abs=0.01)


def test_independent_errors_are_drawn_as_before(chain):
    free = draw(Population(chain), 300, np.random.default_rng(1))
    tied = draw(Population(chain, dependence=Dependence(NAMES, R)), 300, np.random.default_rng(1))
    others = [p for p, s in enumerate(chain.symbols) if s.name not in NAMES]
    np.testing.assert_array_equal(free.amplitude[:, others], tied.amplitude[:, others])
    np.testing.assert_array_equal(free.phase, tied.phase)


@pytest.mark.parametrize("alike", [False, True])
def test_closed_covariances_are_those_of_drawn_machines(chain, workspace, alike):
    ranges = {name: (0.05, 0.1) for name in ("EXX", "EYX", "EYY")} | {"EC0Y": (2e-4, 4e-4)}
    together = Group(("EXX", "EYX", "-EYY"), 0.9, alike)
    both = Group(("EC0Y", "EXC1"), 0.7)
    population = only(
        chain,
        ranges | {"EXC1": (0.03, 0.05)},
        distributions=Distributions(("linear", "parabolic", "sinusoidal"), periods=(1, 2)),
        dependence=grouped([together, both]),
    )
    q = latin_hypercube(workspace, 12, np.random.default_rng(2))
    theta = coefficients(population, draw(population, 40_000, np.random.default_rng(3)))
    d = first_order(population.model, q, LENGTH) @ theta.T
    sampled = np.einsum("nis,njs->nij", d, d) / len(theta)
    closed = covariance(population, q, LENGTH)
    scale = np.einsum("nii->n", closed)
    # relative standard error of a second moment by 40 000 draws: below 0.01
    assert np.abs(sampled - closed).max() < 0.03 * scale.max()
    independent = covariance(only(chain, ranges), q, LENGTH)
    assert np.abs(independent - closed).max() > 0.1 * scale.max()
    np.testing.assert_allclose(variance_parts(population, q, LENGTH).sum(axis=1), scale, rtol=1e-12)
    np.testing.assert_allclose(rms(population, q, LENGTH) ** 2, scale, rtol=1e-12)


def test_errors_of_one_cause_cancel_where_their_signs_are_opposite(chain):
    # EXX and EXY both move along x: fully correlated with opposite signs and one range, nothing
    # is left where both have the same shape function, here constants
    population = only(
        chain,
        {"EXX": (0.02, 0.05), "EXY": (0.02, 0.05)},
        distributions=Distributions(("constant",)),
        dependence=grouped([Group(("EXX", "-EXY"))]),
    )
    q = np.zeros((1, len(chain.axes)))
    assert rms(population, q, LENGTH)[0] < 1e-6
    each = variance_parts(population, q, LENGTH)[0]
    assert np.abs(each).max() < 1e-9


def test_members_alike_share_their_shape(chain):
    population = Population(chain, dependence=grouped([Group(("EXX", "EZX"), 1.0, True)]))
    for seed in range(4):
        drawn = [e for e, _ in drawn_errors(population, np.random.default_rng(seed))]
        one, two = (
            next(e for e in drawn if isinstance(e, ComponentError) and e.symbol.name == name)
            for name in ("EXX", "EZX")
        )
        assert (one.shape, one.periods, one.phase) == (two.shape, two.periods, two.phase)


def test_errors_of_amplitude_zero_may_be_correlated(chain):
    ranges = RANGES | {"EYX": (0.0, 0.0)}
    population = only(chain, ranges, dependence=Dependence(NAMES, R))
    draws = draw(population, 100, np.random.default_rng(1))
    assert np.isfinite(draws.amplitude).all()
    assert np.abs(draws.amplitude[:, column(chain, "EYX")]).max() == 0.0


@pytest.mark.parametrize(
    ("wrong", "words"),
    [
        (
            lambda: Dependence(NAMES, [[1, 0.9, -0.9], [0.9, 1, 0.9], [-0.9, 0.9, 1]]),
            "EXX, EYX, EC0Y is not positive semidefinite: its smallest eigenvalue is -0.8",
        ),
        (lambda: Dependence(NAMES, np.eye(2)), "of shape .2, 2. for 3 errors"),
        (lambda: Dependence(("EXX", "EYX"), [[1, 0.5], [0.4, 1]]), "not symmetric"),
        (lambda: Dependence(("EXX", "EYX"), [[2, 0.5], [0.5, 2]]), "ones on its diagonal"),
        (lambda: Dependence(("EXX", "EXX"), np.eye(2)), "every error once"),
        (lambda: Dependence(("EXX", "EYX"), [[1, np.nan], [np.nan, 1]]), "finite"),
        (lambda: Group(("EXX",)), "two errors at least"),
        (lambda: Group(("EXX", "EYX"), -0.2), "write -EYX"),
    ],
)
def test_what_no_machines_can_have_is_refused(wrong, words):
    with pytest.raises(DesignError, match=words):
        wrong()


def test_what_this_machine_cannot_have_is_refused(chain):
    with pytest.raises(DesignError, match="EQX"):
        Population(chain, dependence=grouped([Group(("EXX", "EQX"))]))
    # even amplitudes of [0.05, 0.1] and [0, 0.08]: at most 0.945 (by hand: (1/2 + 1/3)/sd/sd)
    with pytest.raises(DesignError, match=r"cannot be correlated so much; 0\.94\d times"):
        only(chain, dependence=grouped([Group(("EXX", "EYX"), 1.0)]))
    with pytest.raises(DesignError, match="the same shapes to draw from"):
        Population(
            chain,
            distributions=Distributions(by_name={"EYX": Mix(("linear",))}),
            dependence=grouped([Group(("EXX", "EYX"), 0.5, True)]),
        )
