"""Tail probabilities against closed forms and against simulated noise."""

import numpy as np
import pytest
from scipy import stats

from matstd.diagnosis.regression import f_probability
from matstd.diagnosis.residual.pattern_tests import ratio_probability

A_FEW_PER_CENT = 0.05


@pytest.mark.parametrize("k", [1, 4, 40])
@pytest.mark.parametrize("level", [0.3, 1e-2, 1e-5, 1e-12])
def test_equal_weights_are_a_beta_distribution(k: int, level: float) -> None:
    dof = 300
    statistic = stats.beta.isf(level, k / 2, (dof - k) / 2)
    p = ratio_probability(np.array([statistic]), np.ones((1, k)), dof)
    assert p[0] == pytest.approx(level, rel=0.15 if k == 1 else A_FEW_PER_CENT)


def test_no_ratio_is_sure_to_be_reached() -> None:
    assert ratio_probability(np.zeros(1), np.ones((1, 3)), 40)[0] == 1.0


def test_unequal_weights_against_simulated_noise() -> None:
    rng = np.random.default_rng(5)
    weights = np.exp(-np.arange(20) / 3.0)
    z = rng.standard_normal((100_000, 120)) ** 2
    ratio = z[:, :20] @ weights / z.sum(axis=1)
    for level in (0.2, 0.02, 0.002):
        statistic = np.quantile(ratio, 1.0 - level)
        p = ratio_probability(np.array([statistic]), weights[None], 120)
        assert p[0] == pytest.approx(level, rel=0.12)  # 200 of the noises are beyond the last


def test_zeros_that_pad_the_weights_change_nothing() -> None:
    weights = np.array([[3.0, 1.0, 0.5]])
    padded = np.pad(weights, ((0, 0), (0, 4)))
    at = np.array([0.05])
    assert ratio_probability(at, padded, 200)[0] == pytest.approx(
        ratio_probability(at, weights, 200)[0], rel=1e-6
    )


@pytest.mark.parametrize(("drop", "k"), [(4.0, 1), (30.0, 3), (400.0, 2)])
def test_f_probability_is_that_of_scipy(drop: float, k: int) -> None:
    F = (drop / k) / (500.0 / 480.0)
    assert f_probability(drop, k, 500.0, 480.0) == pytest.approx(stats.f.sf(F, k, 480.0), rel=1e-9)
