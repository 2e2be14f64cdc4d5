"""Elimination by blocks against dense matrices of numpy."""

import numpy as np
import pytest
from scipy.sparse import csr_array

from matstd.artefact.certify.block_tridiagonal import Blocks, Eliminated


def banded(count, half, rng):
    """A random symmetric positive definite matrix (count, count) of some half bandwidth."""
    i, j = np.indices((count, count))
    A = np.where(np.abs(i - j) <= half, rng.normal(size=(count, count)), 0.0)
    return A + A.T + 4.0 * (half + 1.0) * np.eye(count)


@pytest.mark.parametrize(("count", "size"), [(12, 4), (14, 4), (5, 5), (3, 7), (31, 6)])
def test_solution_inverse_and_trace_are_those_of_the_whole_matrix(count, size):
    rng = np.random.default_rng(count)
    A, G = (banded(count, size - 1, rng) for _ in "AG")
    of_A, of_G = (Blocks.of(csr_array(M), size) for M in (A, G))
    np.testing.assert_array_equal(of_A.sparse().toarray(), A)
    whole = of_A.plus(of_G, 0.3, 0.7)
    dense = A + 0.3 * G + 0.7 * np.eye(count)
    np.testing.assert_allclose(whole.sparse().toarray(), dense, atol=1e-14)
    eliminated, right = Eliminated(whole), rng.normal(size=(count, 2))
    np.testing.assert_allclose(eliminated.solve(right), np.linalg.solve(dense, right), atol=1e-12)
    inverse, found = np.linalg.inv(dense), eliminated.inverse()
    number = np.arange(count) // size
    near = np.abs(number[:, None] - number) <= 1
    np.testing.assert_allclose(found.sparse().toarray(), np.where(near, inverse, 0.0), atol=1e-13)
    assert found.dot(of_G) == pytest.approx(np.trace(inverse @ G), rel=1e-12)
