"""Maps without sampling: against textbook distributions, drawn vectors and the Monte Carlo."""

import numpy as np
import pytest
from scipy.stats import chi

from matstd.sensitivity.first_order import covariance, jacobian, latin_hypercube, normal_length
from matstd.sensitivity.first_order.indices import mean_squares
from matstd.sensitivity.first_order.normal_lengths import LEVELS
from matstd.sensitivity.montecarlo import volumetric
from matstd.sensitivity.population import Population

TABLE = 2e-4
"""Interpolation of the table may be off by so much of the value."""
LENGTH = 160.0


def matrices(count):
    """Covariances of every kind: round, flat, thin, turned at random."""
    rng = np.random.default_rng(1)
    A = rng.normal(size=(count, 3, 3)) * rng.uniform(0.0, 1.0, (count, 1, 3)) ** 2
    return A @ np.swapaxes(A, 1, 2)


@pytest.mark.parametrize("dimensions", [1, 2, 3])
def test_round_flat_and_thin_ones_are_chi_distributed(dimensions):
    C = 0.04 * np.diag([1.0 if i < dimensions else 0.0 for i in range(3)])[None]
    found, known = normal_length(C), chi(dimensions, scale=0.2)
    assert found.rms[0] == pytest.approx(0.2 * np.sqrt(dimensions), rel=1e-12)
    assert found.mean[0] == pytest.approx(known.mean(), rel=TABLE)
    scatter = np.sqrt(found.rms[0] ** 2 - found.mean[0] ** 2)
    assert scatter == pytest.approx(known.std(), rel=10 * TABLE)
    np.testing.assert_allclose(found.quantile[:, 0], known.ppf(LEVELS), rtol=TABLE)


def test_any_shape_against_drawn_vectors():
    C = matrices(12)
    found = normal_length(C)
    for k, each in enumerate(C):
        drawn = np.random.default_rng(k).multivariate_normal(np.zeros(3), each, 200_000)
        size = np.linalg.norm(drawn, axis=1)
        # 200 000 draws know a mean to 0.2 % and a 99 % quantile to 0.4 %: four times that
        assert found.mean[k] == pytest.approx(size.mean(), rel=0.008)
        np.testing.assert_allclose(found.quantile[:, k], np.quantile(size, LEVELS), rtol=0.016)


def test_covariance_by_axes_is_the_sum_over_parameters(chain, workspace):
    population = Population(chain)
    q = latin_hypercube(workspace, 50, np.random.default_rng(2))
    J = jacobian(chain, q, LENGTH)
    plain = np.einsum("npi,np,npj->nij", J, mean_squares(population, q), J)
    found = covariance(population, q, LENGTH)
    np.testing.assert_allclose(found, plain, rtol=0, atol=1e-12 * plain.max())


def test_many_independent_errors_are_nearly_normal(chain, workspace):
    q = latin_hypercube(workspace, 40, np.random.default_rng(7))
    population = Population(chain)
    drawn = volumetric(population, q, LENGTH, 8000, np.random.default_rng(11))
    closed = normal_length(covariance(population, q, LENGTH))
    # 8 000 draws know the mean to 0.6 %; amplitudes are bounded, so the tail may be 3 % shorter
    assert np.abs(closed.mean / drawn.mean - 1.0).max() < 0.03
    assert np.abs(closed.p95 / drawn.p95 - 1.0).max() < 0.06


def test_no_error_has_no_length():
    found = normal_length(np.zeros((2, 3, 3)))
    assert found.mean.max() == found.quantile.max() == 0.0
