"""Power of the test for a smooth field: against a Monte Carlo that shares nothing with it."""

import numpy as np
import pytest

from matstd.information.power import decorrelated, exceedance, field_test, low_rank, quantile

N, DRAWS = 60, 20_000


@pytest.fixture(scope="module")
def case():
    """A field along a line beside an unknown offset and slope, by dense matrices."""
    x = np.linspace(0.0, 100.0, N)
    B = np.column_stack([np.full(N, 30.0), 30.0 * x / 100.0])
    K = 0.6**2 * np.exp(-0.5 * (x[:, None] - x) ** 2 / 12.0**2)
    F, _ = low_rank(np.diag(K), lambda i: K[i], 1e-9)
    V0 = np.eye(N) + B @ B.T
    ratio = np.linalg.inv(V0) - np.linalg.inv(V0 + K)  # twice the log of the likelihood ratio
    return x, B, K, V0, ratio, field_test(B, F, 0.05)


def rate(case, field):
    """Share of drawn measurements at which the test by dense matrices finds something."""
    _, B, _, _, ratio, test = case
    rng = np.random.default_rng(5)
    y = rng.normal(size=(DRAWS, N)) + rng.normal(size=(DRAWS, 2)) @ B.T + field
    return np.mean(np.einsum("ki,ij,kj->k", y, ratio, y) > test.threshold)


def test_the_statistic_is_the_likelihood_ratio(case):
    _, _, _, _, ratio, test = case
    y = np.random.default_rng(1).normal(size=(N, 7))
    np.testing.assert_allclose(test.statistic(y), np.einsum("ik,ij,jk->k", y, ratio, y), rtol=1e-6)


def test_false_alarms_have_the_stated_risk(case):
    assert rate(case, 0.0) == pytest.approx(0.05, abs=0.006)  # 4 standard deviations of the draws


@pytest.mark.parametrize("height", [0.7, 1.3, 2.2])
def test_power_against_a_bump(case, height):
    x, *_, test = case
    bump = height * np.exp(-0.5 * (x - 40.0) ** 2 / 9.0**2)
    assert test.power(bump[:, None])[0] == pytest.approx(rate(case, bump), abs=0.015)


def test_power_against_a_random_field(case):
    _, _, K, _, _, test = case
    rng = np.random.default_rng(6)
    F = np.linalg.cholesky(2.0 * K + 1e-9 * np.eye(N))
    drawn = rng.normal(size=(DRAWS, N)) @ F.T
    assert test.power_of_field(F) == pytest.approx(rate(case, drawn), abs=0.015)


def test_signal_is_the_root_of_the_noncentrality(case):
    x, B, _, V0, _, test = case
    f = np.column_stack([np.sin(x / 9.0), B[:, 0] + B[:, 1]])
    expected = np.sqrt(np.einsum("ik,ij,jk->k", f, np.linalg.inv(V0), f))
    np.testing.assert_allclose(test.signal(f), expected, rtol=1e-6)
    assert test.signal(f)[1] < 1.5  # two columns of what is explained: one prior each


def test_more_points_than_the_field_needs_waste_nothing(case):
    """Ten points of ten times the variance for each: a chi-square per point would drown."""
    x, B, K, *_, test = case
    bump = 1.3 * np.exp(-0.5 * (x - 40.0) ** 2 / 9.0**2)
    F, _ = low_rank(np.diag(K), lambda i: K[i], 1e-9)
    many = [np.repeat(a, 10, axis=0) / np.sqrt(10.0) for a in (B, F, bump[:, None])]
    assert field_test(*many[:2], 0.05).power(many[2])[0] == pytest.approx(
        test.power(bump[:, None])[0], abs=1e-3
    )


def test_tails_are_those_of_chi_squares():
    from scipy.stats import chi2, ncx2

    for n in (1, 4, 60):
        square = np.zeros((3, n))
        square[:, 0] = [0.0, 3.0, 25.0]
        for x in (0.3 * n, n + 0.0, 2.0 * n, 3.0 * n + 10.0):
            expected = [chi2.sf(x, n), ncx2.sf(x, n, 3.0), ncx2.sf(x, n, 25.0)]
            found = exceedance(np.ones(n), square, x)
            np.testing.assert_allclose(found, expected, rtol=0.03, atol=0.01 if n == 1 else 1e-3)
        assert quantile(np.ones(n), 0.05) == pytest.approx(chi2.isf(0.05, n), rel=0.02)


def test_noise_with_memory_becomes_white():
    rng = np.random.default_rng(2)
    u, memory = rng.uniform(0.5, 2.0, 6), np.array([0.0, 0.8, 0.8, 0.0, 0.5, 0.5])
    cov = np.eye(6)
    for i in range(1, 6):
        cov[i, :i] = cov[:i, i] = memory[i] * cov[i - 1, :i]
    cov *= u[:, None] * u
    white = decorrelated(np.linalg.cholesky(cov), u, memory)
    np.testing.assert_allclose(white @ white.T, np.eye(6), atol=1e-12)
