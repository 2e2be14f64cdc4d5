"""The algebra of the fit against the same sums done the long way."""

import numpy as np
import pytest

from matstd.diagnosis.regression import left_out, solve

ROUNDING = 1e-9


@pytest.fixture
def problem() -> tuple[np.ndarray, np.ndarray]:
    rng = np.random.default_rng(3)
    X = rng.standard_normal((60, 7)) * np.array([30.0, 10.0, 3.0, 1.0, 0.3, 0.0, 5.0])
    X[:, 6] = X[:, 0]  # two columns alike: only the prior distinguishes them
    return X, X @ rng.standard_normal(7) + rng.standard_normal(60)


def test_objective_is_the_marginal_likelihood_and_leverage_its_complement(problem) -> None:
    X, y = problem
    fit = solve(X, y)
    marginal = np.linalg.inv(np.eye(60) + X @ X.T)
    assert fit.objective == pytest.approx(y @ marginal @ y, rel=1e-9)
    assert np.allclose(1.0 - fit.leverage, np.diag(marginal), atol=ROUNDING)


def test_a_column_that_nothing_sees_keeps_its_prior(problem) -> None:
    X, y = problem
    fit = solve(X, y)
    assert fit.phi[5] == 0.0
    assert fit.covariance[5, 5] == pytest.approx(1.0)


def test_more_parameters_than_touches_is_no_trouble() -> None:
    rng = np.random.default_rng(1)
    X, y = rng.standard_normal((5, 20)), rng.standard_normal(5)
    fit = solve(X, y)
    assert fit.effective_parameters < 5.0
    assert np.allclose(fit.phi, X.T @ np.linalg.solve(np.eye(5) + X @ X.T, y), atol=ROUNDING)


@pytest.mark.parametrize("size", [3, 20])
def test_left_out_groups_are_those_of_a_new_fit(problem, size: int) -> None:
    """Both branches: groups smaller and larger than the number of parameters."""
    X, y = problem
    fit = solve(X, y)
    groups = [np.arange(i, i + size) for i in range(0, 60, size)]
    quick = left_out(fit.Q, fit.residual, groups)
    squared, log_det = 0.0, 0.0
    for rows in groups:
        others = np.setdiff1d(np.arange(60), rows)
        again = solve(X[others], y[others])
        error = y[rows] - X[rows] @ again.phi
        covariance = np.eye(size) + X[rows] @ again.covariance @ X[rows].T
        assert np.allclose(quick.error[rows], error, atol=1e-7)
        squared += error @ np.linalg.solve(covariance, error)
        log_det += np.linalg.slogdet(covariance)[1]
    assert quick.squared == pytest.approx(squared, rel=1e-7)
    assert quick.log_det == pytest.approx(log_det, rel=1e-7)
