"""Total effects by rank-one updates against conditional variances and a known case."""

import numpy as np
import pytest

from sensitivity.total_effects import total_effects
from twin.errors import ShapeMismatch

SINGLE = 1e-5
"""Indices are off by so little where the compiled code calculates in single precision."""


def random_case(draws):
    rng = np.random.default_rng(1)
    J = rng.normal(size=(5, 3, 40))
    a, b = rng.normal(size=(2, 5, draws)) * np.array([1.0, 0.2, 0.5, 2.0, 0.0])[:, None]
    return J, a, b


@pytest.mark.parametrize("compiled", [False, True])
def test_against_variances_at_given_other_errors(compiled):
    # T_p = E[Var(f | all but p)] / Var f, by two nested loops that know nothing of updates
    J, a, b = random_case(8192)
    found = total_effects(J, a, b, compiled)
    rng = np.random.default_rng(2)
    for p in range(5):
        outer = np.repeat(a[:, :1500, None], 60, axis=2)
        outer[p] = rng.normal(size=(1500, 60)) * a[p].std()
        d = np.einsum("pi,pmk->imk", J[:, :, 7], outer)
        f = np.linalg.norm(d, axis=0)
        inside = f.var(axis=1, ddof=1).mean()
        whole = np.linalg.norm(J[:, :, 7].T @ a, axis=0).var()
        # 1500 conditional variances, scattered by about their mean: 3 %; the estimator the same
        assert found[p, 7] == pytest.approx(inside / whole, abs=0.05)
    assert found[4].max() < SINGLE  # an error that never varies


def test_compiled_and_plain_agree():
    case = random_case(300)
    np.testing.assert_allclose(
        total_effects(*case), total_effects(*case, False), rtol=0, atol=SINGLE
    )


def test_one_error_alone_is_everything():
    J, a, b = random_case(20_000)
    found = total_effects(J[:1], a[:1], b[:1])
    np.testing.assert_allclose(found, 1.0, atol=0.05)


def test_nothing_varies_and_nothing_fits():
    J, a, b = random_case(10)
    assert total_effects(J, 0.0 * a, 0.0 * b).max() == 0.0
    with pytest.raises(ShapeMismatch, match="5 columns"):
        total_effects(J, a[:4], b[:4])
