"""Touches of one feature that are off together, by numbers alone."""

import numpy as np
import pytest

from matstd.diagnosis.regression.features import Features, whole_features
from matstd.diagnosis.regression.linear import solve

TOUCHES, FEATURES = 70, 7


def left_by(parameters: int, offset: float, seed: int):
    """A fit of so many free parameters, and the features; the first lies off by noises."""
    rng = np.random.default_rng(seed)
    number = np.repeat(np.arange(FEATURES), TOUCHES // FEATURES)
    X = 30.0 * rng.normal(size=(TOUCHES, parameters))
    y = X @ rng.normal(size=parameters) + rng.normal(size=TOUCHES) + offset * (number == 0)
    fit = solve(X, y)
    features = Features(number, rng.uniform(-100.0, 100.0, (TOUCHES, 3)))
    return whole_features(fit.residual, fit, np.ones(TOUCHES, dtype=bool), features).rows


@pytest.mark.parametrize("seed", range(5))
def test_a_dirty_feature_is_taken_out_whole(seed) -> None:
    found = left_by(5, 12.0, seed)
    assert found[: TOUCHES // FEATURES].all()
    assert not found[TOUCHES // FEATURES :].any()


def test_a_model_of_nearly_as_many_parameters_as_touches_accuses_no_feature() -> None:
    """It leaves a tenth of the noise, beside which any feature would be far off."""
    assert not any(left_by(64, 0.0, seed).any() for seed in range(40))
