"""Distinct rows against numpy's own."""

import numpy as np
import pytest

from matstd.twin.numbers import distinct_rows


@pytest.mark.parametrize("shape", [(400, 2), (1, 3), (50, 1), (7, 4)])
def test_distinct_rows_are_those_of_numpy_in_its_order(shape: tuple[int, int]) -> None:
    rows = np.random.default_rng(0).integers(-2, 3, shape) * 0.5
    rows[::3] *= -1.0  # zeros of both signs are one number
    found, number = distinct_rows(rows)
    expected, back = np.unique(rows, axis=0, return_inverse=True)
    np.testing.assert_array_equal(found, expected)
    np.testing.assert_array_equal(number, back.reshape(-1))
    np.testing.assert_array_equal(found[number], rows)


def test_rows_of_no_column_are_one() -> None:
    found, number = distinct_rows(np.zeros((3, 0)))
    assert found.shape == (1, 0)
    assert number.tolist() == [0, 0, 0]
